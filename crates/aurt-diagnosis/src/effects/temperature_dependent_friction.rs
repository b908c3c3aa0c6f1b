//! x
use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::*;

pub(super) struct TemperatureDependentFriction;

impl Effect for TemperatureDependentFriction {
    fn id(&self) -> &'static str {
        "temperature_dependent_friction"
    }

    fn family(&self) -> Family {
        Family::V
    }

    fn title(&self) -> &'static str {
        "friction that drifts along the recording, as with warming lubricant"
    }

    fn decider(&self) -> &'static str {
        "a long recording of one repeated motion from a cold start"
    }

    fn source(&self) -> &'static str {
        include_str!("temperature_dependent_friction.rs")
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        (0..context.joints)
            .map(|j| Proposal::on_joint(j, json!({"model":"temperature","joints":[j]}), vec![]))
            .collect()
    }

    fn parameters(
        &self,
        proposal: &Proposal,
        fitted: &[(String, f64, f64)],
    ) -> BTreeMap<String, (Value, Value)> {
        let _ = proposal;
        fitted.iter().map(|(name, value, std)| (name.clone(), (json!(value), json!(std)))).collect()
    }
}
