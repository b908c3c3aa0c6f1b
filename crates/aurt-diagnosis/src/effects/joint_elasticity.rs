//! x
use std::collections::BTreeMap;

use serde_json::Value;

use super::*;

pub(super) struct JointElasticity;

impl Effect for JointElasticity {
    fn id(&self) -> &'static str {
        "joint_elasticity"
    }

    fn family(&self) -> Family {
        Family::P
    }

    fn title(&self) -> &'static str {
        "an elastic transmission"
    }

    fn decider(&self) -> &'static str {
        "fast reversals at a rate of 500 Hz or more, with a link-side sensor if there is one"
    }

    fn source(&self) -> &'static str {
        include_str!("joint_elasticity.rs")
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        (0..context.joints).map(|j| Proposal::instrument(j, Instrument::Jerk, true)).collect()
    }

    fn parameters(
        &self,
        proposal: &Proposal,
        fitted: &[(String, f64, f64)],
    ) -> BTreeMap<String, (Value, Value)> {
        let _ = proposal;
        named(&["inertia_over_stiffness_s2"], fitted)
    }
}
