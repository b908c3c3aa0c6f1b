//! x
use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::*;

pub(super) struct CurrentOffset;

impl Effect for CurrentOffset {
    fn id(&self) -> &'static str {
        "current_offset"
    }

    fn family(&self) -> Family {
        Family::D
    }

    fn title(&self) -> &'static str {
        "a constant offset of the measurement"
    }

    fn decider(&self) -> &'static str {
        "the measurement with the drives off"
    }

    fn source(&self) -> &'static str {
        include_str!("current_offset.rs")
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        (0..context.joints)
            .map(|j| Proposal::on_joint(j, json!({"model":"current_offset","joints":[j]}), vec![]))
            .collect()
    }

    fn parameters(
        &self,
        proposal: &Proposal,
        fitted: &[(String, f64, f64)],
    ) -> BTreeMap<String, (Value, Value)> {
        let _ = proposal;
        named(&["offset"], fitted)
    }
}
