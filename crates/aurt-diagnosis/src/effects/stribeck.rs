//! x
use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::*;

pub(super) struct Stribeck;

impl Effect for Stribeck {
    fn id(&self) -> &'static str {
        "stribeck"
    }

    fn family(&self) -> Family {
        Family::F
    }

    fn title(&self) -> &'static str {
        "Stribeck friction (friction falls as motion sets in)"
    }

    fn decider(&self) -> &'static str {
        "constant slow velocities between 0.001 and 0.2 rad/s"
    }

    fn source(&self) -> &'static str {
        include_str!("stribeck.rs")
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        (0..context.joints)
            .flat_map(|j| {
                [0.01, 0.02, 0.05, 0.1, 0.2].map(|v| {
                    Proposal::on_joint(
                        j,
                        joint_friction(
                            j,
                            json!({"model":"stribeck","stribeck_velocity_rad_s":v}),
                            json!({"model":"sign"}),
                            &[],
                        ),
                        vec![false, true],
                    )
                    .with("stribeck_velocity_rad_s", v)
                })
            })
            .collect()
    }

    fn parameters(
        &self,
        proposal: &Proposal,
        fitted: &[(String, f64, f64)],
    ) -> BTreeMap<String, (Value, Value)> {
        let mut p = BTreeMap::new();
        if let Some((_, value, std)) = fitted.last() {
            p.insert("static_excess_nm".to_owned(), (json!(value), json!(std)));
        }
        if let Some(v) = proposal.fixed.get("stribeck_velocity_rad_s") {
            p.insert("stribeck_velocity_rad_s".to_owned(), (json!(v), Value::Null));
        }
        p
    }
}
