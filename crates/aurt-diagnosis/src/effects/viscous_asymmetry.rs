//! x
use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::*;

pub(super) struct ViscousAsymmetry;

impl Effect for ViscousAsymmetry {
    fn id(&self) -> &'static str {
        "viscous_asymmetry"
    }

    fn family(&self) -> Family {
        Family::V
    }

    fn title(&self) -> &'static str {
        "viscous friction that differs by direction"
    }

    fn decider(&self) -> &'static str {
        "constant velocities in both directions"
    }

    fn source(&self) -> &'static str {
        include_str!("viscous_asymmetry.rs")
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        (0..context.joints)
            .map(|j| Proposal::on_joint(j, json!({"model":"viscous_asymmetric","joints":[j]}), vec![]))
            .collect()
    }

    fn parameters(
        &self,
        proposal: &Proposal,
        fitted: &[(String, f64, f64)],
    ) -> BTreeMap<String, (Value, Value)> {
        let _ = proposal;
        named(&["half_difference_nm_s"], fitted)
    }
}
