//! x
use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::*;

pub(super) struct ViscousNonlinear;

impl Effect for ViscousNonlinear {
    fn id(&self) -> &'static str {
        "viscous_nonlinear"
    }

    fn family(&self) -> Family {
        Family::V
    }

    fn title(&self) -> &'static str {
        "viscous friction that is not proportional to velocity"
    }

    fn decider(&self) -> &'static str {
        "constant velocities over the whole range, at constant temperature"
    }

    fn source(&self) -> &'static str {
        include_str!("viscous_nonlinear.rs")
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        (0..context.joints).flat_map(|j| { let mut list = vec![Proposal::on_joint(j, joint_friction(j, json!({"model":"absent"}), json!({"model":"sign"}), &[2]), vec![]).with("power", 2.0), Proposal::on_joint(j, joint_friction(j, json!({"model":"absent"}), json!({"model":"sign"}), &[3]), vec![]).with("power", 3.0)]; for v in [0.1, 0.3, 1.0] { list.push(Proposal::on_joint(j, json!({"model":"joint_friction","joints":[j],"coulomb":{"model":"absent"},"hysteresis":{"model":"sign"},"viscous":{"model":"saturating","saturation_velocity_rad_s":v}}), vec![true]).with("saturation_velocity_rad_s", v)); } list }).collect()
    }

    fn parameters(
        &self,
        proposal: &Proposal,
        fitted: &[(String, f64, f64)],
    ) -> BTreeMap<String, (Value, Value)> {
        let mut p: BTreeMap<String, (Value, Value)> =
            fitted.iter().map(|(name, value, std)| (name.clone(), (json!(value), json!(std)))).collect();
        p.extend(proposal.fixed.iter().map(|(k, v)| (k.clone(), (json!(v), Value::Null))));
        p
    }
}
