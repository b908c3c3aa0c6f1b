//! x
use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::*;

pub(super) struct CoulombAsymmetry;

impl Effect for CoulombAsymmetry {
    fn id(&self) -> &'static str {
        "coulomb_asymmetry"
    }

    fn family(&self) -> Family {
        Family::F
    }

    fn title(&self) -> &'static str {
        "Coulomb friction that differs by direction"
    }

    fn decider(&self) -> &'static str {
        "the current at rest, with the brakes released and with them set: an offset shows there, asymmetric friction does not"
    }

    fn source(&self) -> &'static str {
        include_str!("coulomb_asymmetry.rs")
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        (0..context.joints)
            .map(|j| Proposal::on_joint(j, json!({"model":"coulomb_asymmetric","joints":[j]}), vec![]))
            .collect()
    }

    fn parameters(
        &self,
        proposal: &Proposal,
        fitted: &[(String, f64, f64)],
    ) -> BTreeMap<String, (Value, Value)> {
        let _ = proposal;
        named(&["half_difference_nm"], fitted)
    }
}
