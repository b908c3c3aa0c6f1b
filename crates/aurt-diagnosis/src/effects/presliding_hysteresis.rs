//! x
use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::*;

pub(super) struct PreslidingHysteresis;

impl Effect for PreslidingHysteresis {
    fn id(&self) -> &'static str {
        "presliding_hysteresis"
    }

    fn family(&self) -> Family {
        Family::H
    }

    fn title(&self) -> &'static str {
        "presliding hysteresis (friction builds up over the first travel after each reversal)"
    }

    fn decider(&self) -> &'static str {
        "slow triangular motion of one joint with amplitudes from 0.001 to 0.1 rad"
    }

    fn source(&self) -> &'static str {
        include_str!("presliding_hysteresis.rs")
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        (0..context.joints)
            .map(|j| {
                Proposal::on_joint(
                    j,
                    joint_friction(j, json!({"model":"none"}), json!({"model":"maxwell_slip"}), &[]),
                    vec![true; 5],
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
        fitted.iter().map(|(name, value, std)| (name.clone(), (json!(value), json!(std)))).collect()
    }
}
