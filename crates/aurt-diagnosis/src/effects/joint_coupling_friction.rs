//! x
use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::*;

pub(super) struct JointCouplingFriction;

impl Effect for JointCouplingFriction {
    fn id(&self) -> &'static str {
        "joint_coupling_friction"
    }

    fn family(&self) -> Family {
        Family::C
    }

    fn title(&self) -> &'static str {
        "friction and inertia of a motor that turns with two joints"
    }

    fn decider(&self) -> &'static str {
        "each of the two joints moving alone"
    }

    fn source(&self) -> &'static str {
        include_str!("joint_coupling_friction.rs")
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        let mut list = Vec::new();
        for joint in 0..context.joints {
            for partner in joint + 1..context.joints {
                for ratio in [-2.0, -1.0, -0.5, 0.5, 1.0, 2.0] {
                    list.push(
                        Proposal {
                            joints: vec![joint, partner],
                            addition: Addition::Term(
                                json!({"model":"coupling","joint":joint,"partner":partner,"ratio":ratio}),
                            ),
                            nonnegative: vec![true; 3],
                            presence: Presence::Any,
                            fixed: BTreeMap::new(),
                        }
                        .with("partner", partner as f64)
                        .with("ratio", ratio),
                    );
                }
            }
        }
        list
    }

    fn parameters(
        &self,
        proposal: &Proposal,
        fitted: &[(String, f64, f64)],
    ) -> BTreeMap<String, (Value, Value)> {
        let mut p = named(&["inertia_kg_m2", "viscous_nm_s", "coulomb_nm"], fitted);
        p.extend(proposal.fixed.iter().map(|(k, v)| (k.clone(), (json!(v), Value::Null))));
        p
    }
}
