//! x
use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::*;

pub(super) struct RotorInertia;

impl Effect for RotorInertia {
    fn id(&self) -> &'static str {
        "rotor_inertia"
    }

    fn family(&self) -> Family {
        Family::I
    }

    fn title(&self) -> &'static str {
        "inertia of the motor's rotor"
    }

    fn decider(&self) -> &'static str {
        "fast reversals of one joint at a time"
    }

    fn source(&self) -> &'static str {
        include_str!("rotor_inertia.rs")
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        (0..context.joints)
            .map(|j| Proposal::on_joint(j, json!({"model":"rotor_inertia","joints":[j]}), vec![true]))
            .collect()
    }

    fn parameters(
        &self,
        proposal: &Proposal,
        fitted: &[(String, f64, f64)],
    ) -> BTreeMap<String, (Value, Value)> {
        let _ = proposal;
        named(&["inertia_kg_m2"], fitted)
    }
}
