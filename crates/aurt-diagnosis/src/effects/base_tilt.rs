//! x
use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::*;

pub(super) struct BaseTilt;

impl Effect for BaseTilt {
    fn id(&self) -> &'static str {
        "base_tilt"
    }

    fn family(&self) -> Family {
        Family::I
    }

    fn title(&self) -> &'static str {
        "a base that is not mounted as the gravity vector says"
    }

    fn decider(&self) -> &'static str {
        "a spirit level on the base"
    }

    fn source(&self) -> &'static str {
        include_str!("base_tilt.rs")
    }

    fn whole_arm(&self) -> bool {
        true
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        let columns: Vec<usize> = context.inertial.iter().map(|(c, _)| *c).collect();
        let coefficients: Vec<f64> = context.inertial.iter().map(|(_, v)| *v).collect();
        vec![Proposal {
            joints: (0..context.joints).collect(),
            addition: Addition::Term(
                json!({"model":"base_tilt","inertial_columns": columns, "inertial_values": coefficients, "first_axis": true}),
            ),
            nonnegative: vec![],
            presence: Presence::Any,
            fixed: BTreeMap::new(),
        }]
    }

    fn parameters(
        &self,
        proposal: &Proposal,
        fitted: &[(String, f64, f64)],
    ) -> BTreeMap<String, (Value, Value)> {
        let _ = proposal;
        named(&["roll_rad", "pitch_rad"], fitted)
    }
}
