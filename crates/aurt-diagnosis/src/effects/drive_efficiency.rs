//! x
use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::*;

pub(super) struct DriveEfficiency;

impl Effect for DriveEfficiency {
    fn id(&self) -> &'static str {
        "drive_efficiency"
    }

    fn family(&self) -> Family {
        Family::L
    }

    fn title(&self) -> &'static str {
        "transmission losses that differ between driving and being driven"
    }

    fn decider(&self) -> &'static str {
        "lifting and lowering the same load at the same speed"
    }

    fn source(&self) -> &'static str {
        include_str!("drive_efficiency.rs")
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        (0..context.joints)
            .map(|j| Proposal::on_joint(j, json!({"model":"drive_efficiency","joints":[j]}), vec![]))
            .collect()
    }

    fn parameters(
        &self,
        proposal: &Proposal,
        fitted: &[(String, f64, f64)],
    ) -> BTreeMap<String, (Value, Value)> {
        let _ = proposal;
        named(&["driving", "driven"], fitted)
    }
}
