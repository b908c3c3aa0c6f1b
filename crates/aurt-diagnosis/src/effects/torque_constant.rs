//! x
use std::collections::BTreeMap;

use serde_json::Value;

use super::*;

pub(super) struct TorqueConstant;

impl Effect for TorqueConstant {
    fn id(&self) -> &'static str {
        "torque_constant"
    }

    fn family(&self) -> Family {
        Family::D
    }

    fn title(&self) -> &'static str {
        "a torque constant (drive gain) that is off"
    }

    fn decider(&self) -> &'static str {
        "a known load"
    }

    fn source(&self) -> &'static str {
        include_str!("torque_constant.rs")
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        (0..context.joints).map(|j| Proposal::instrument(j, Instrument::Gain, false)).collect()
    }

    fn parameters(
        &self,
        proposal: &Proposal,
        fitted: &[(String, f64, f64)],
    ) -> BTreeMap<String, (Value, Value)> {
        let _ = proposal;
        named(&["gain_error"], fitted)
    }
}
