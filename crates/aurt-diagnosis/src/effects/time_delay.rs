//! x
use std::collections::BTreeMap;

use serde_json::Value;

use super::*;

pub(super) struct TimeDelay;

impl Effect for TimeDelay {
    fn id(&self) -> &'static str {
        "time_delay"
    }

    fn family(&self) -> Family {
        Family::D
    }

    fn title(&self) -> &'static str {
        "a delay between motion and measurement"
    }

    fn decider(&self) -> &'static str {
        "time stamps of both from one clock"
    }

    fn source(&self) -> &'static str {
        include_str!("time_delay.rs")
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        (0..context.joints).map(|j| Proposal::instrument(j, Instrument::Delay, true)).collect()
    }

    fn parameters(
        &self,
        proposal: &Proposal,
        fitted: &[(String, f64, f64)],
    ) -> BTreeMap<String, (Value, Value)> {
        let _ = proposal;
        named(&["delay_s"], fitted)
    }
}
