//! x
use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::*;

pub(super) struct FrictionLevelChanged;

impl Effect for FrictionLevelChanged {
    fn id(&self) -> &'static str {
        "friction_level_changed"
    }

    fn family(&self) -> Family {
        Family::F
    }

    fn title(&self) -> &'static str {
        "the same friction at another level than in the calibration recordings"
    }

    fn decider(&self) -> &'static str {
        "the calibration motion again, on the same day as the target"
    }

    fn source(&self) -> &'static str {
        include_str!("friction_level_changed.rs")
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        (0..context.joints)
            .map(|j| Proposal {
                presence: Presence::Change,
                ..Proposal::on_joint(
                    j,
                    joint_friction(j, json!({"model":"none"}), json!({"model":"sign"}), &[1]),
                    vec![],
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
        named(&["coulomb_change_nm", "viscous_change_nm_s"], fitted)
    }
}
