//! Coulomb friction
use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::*;

pub(super) struct Coulomb;

impl Effect for Coulomb {
    fn id(&self) -> &'static str {
        "coulomb"
    }

    fn family(&self) -> Family {
        Family::F
    }

    fn title(&self) -> &'static str {
        "Coulomb friction"
    }

    fn decider(&self) -> &'static str {
        "slow motion in both directions"
    }

    fn source(&self) -> &'static str {
        include_str!("coulomb.rs")
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        (0..context.joints)
            .map(|j| {
                Proposal::on_joint(
                    j,
                    joint_friction(j, json!({"model":"none"}), json!({"model":"sign"}), &[]),
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
        named(&["coulomb_nm"], fitted)
    }
}
