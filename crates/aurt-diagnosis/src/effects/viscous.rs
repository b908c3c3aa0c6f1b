//! x
use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::*;

pub(super) struct Viscous;

impl Effect for Viscous {
    fn id(&self) -> &'static str {
        "viscous"
    }

    fn family(&self) -> Family {
        Family::V
    }

    fn title(&self) -> &'static str {
        "viscous friction"
    }

    fn decider(&self) -> &'static str {
        "constant velocities over the whole range"
    }

    fn source(&self) -> &'static str {
        include_str!("viscous.rs")
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        (0..context.joints)
            .map(|j| {
                Proposal::on_joint(
                    j,
                    joint_friction(j, json!({"model":"absent"}), json!({"model":"sign"}), &[1]),
                    vec![true],
                )
            })
            .collect()
    }

    fn parameters(
        &self,
        proposal: &Proposal,
        fitted: &[(String, f64, f64)],
    ) -> BTreeMap<String, (Value, Value)> {
        let _ = proposal;
        named(&["viscous_nm_s"], fitted)
    }
}
