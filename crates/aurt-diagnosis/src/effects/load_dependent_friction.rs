//! x
use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::*;

pub(super) struct LoadDependentFriction;

impl Effect for LoadDependentFriction {
    fn id(&self) -> &'static str {
        "load_dependent_friction"
    }

    fn family(&self) -> Family {
        Family::L
    }

    fn title(&self) -> &'static str {
        "friction that grows with the load the joint carries"
    }

    fn decider(&self) -> &'static str {
        "the same motion with and without a known payload"
    }

    fn source(&self) -> &'static str {
        include_str!("load_dependent_friction.rs")
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        (0..context.joints)
            .flat_map(|j| {
                ["absolute", "square"].map(|m| {
                    Proposal::on_joint(
                        j,
                        joint_friction(j, json!({"model":m}), json!({"model":"sign"}), &[]),
                        vec![false, true],
                    )
                    .with("power", if m == "square" { 2.0 } else { 1.0 })
                })
            })
            .collect()
    }

    fn parameters(
        &self,
        proposal: &Proposal,
        fitted: &[(String, f64, f64)],
    ) -> BTreeMap<String, (Value, Value)> {
        let _ = proposal;
        fitted
            .last()
            .map(|(_, value, std)| ("load_coefficient".to_owned(), (json!(value), json!(std))))
            .into_iter()
            .collect()
    }
}
