//! `viscous_nonlinear`: speed-dependent friction that is not in proportion to speed.
//!
//! # What it is
//! τ = Σ_i F_v,i b_i(q̇) with b_i = q̇ |q̇|^(i−1), or saturating, τ = F_vs tanh(q̇/v_s). Lubricant shears thin
//! as it is driven faster, so friction of harmonic drives is concave; churning and air make it convex.
//!
//! - `viscous_2`, `viscous_3`: F_v,2 and F_v,3, Nm (s/rad)^i, or
//! - `saturation_nm`: F_vs ≥ 0, Nm, and `saturation_velocity_rad_s`: v_s, rad/s, usually 0.1–1.
//!
//! # How it shows
//! The residual is curved against velocity and odd in it: of one sign at medium speed, of the other at high
//! speed, since a straight line was already taken out.
//!
//! # Easily confused with
//! - `temperature_dependent_friction`: fast stretches warm the joint, and less friction at high speed looks
//!   concave.
//! - `stribeck` and `presliding_hysteresis`: a saturating law with a small v_s is a smooth Coulomb step.
//! - `load_dependent_friction`, if speed and load go together in the motion.
//!
//! # What to record to be sure
//! Constant velocities up to the highest in use, in both directions and in random order, at constant
//! temperature. A cubic law fails beyond the speeds it was fitted to.
//!
//! # References
//! - C. Makkar, W. E. Dixon, W. G. Sawyer, G. Hu (2005), *A new continuously differentiable friction model for
//!   control systems design*.
//! - A. C. Bittencourt, S. Gunnarsson (2012), *Static friction in a robot joint – modeling and identification
//!   of load and temperature effects*.

use serde_json::json;

use super::{Context, Effect, Family, FittedColumn, Kind, Parameters, Proposal, joint_friction};
use crate::hypotheses::shape::Shape;

/// Powers beside the linear one.
const POWERS: [u32; 2] = [2, 3];

/// Velocities v_s from which the search for the saturating law begins. Below a quarter of a radian per second it is hard to tell
/// from dry friction.
const SATURATION_VELOCITIES_RAD_S: [f64; 3] = [0.25, 0.7, 2.0];

/// Where it is sought: up to a velocity above which the law is a straight line on any arm.
const SATURATION: Shape =
    Shape::logarithmic("saturation_velocity_rad_s", "/viscous/saturation_velocity_rad_s", [0.1, 8.0], 0.5);

pub(super) struct ViscousNonlinear;

impl Effect for ViscousNonlinear {
    fn id(&self) -> &'static str {
        "viscous_nonlinear"
    }

    fn family(&self) -> Family {
        Family::V
    }

    fn kind(&self) -> Kind {
        Kind::Friction
    }

    fn generalises(&self) -> &'static [&'static str] {
        &["viscous"]
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
        let power = |j: usize, power: u32| {
            let term = joint_friction(j, json!({"model": "absent"}), json!({"model": "sign"}), &[power]);
            // Concave friction has a negative coefficient beside a larger slope.
            Proposal::on_joint(j, term, vec![]).with("power", f64::from(power))
        };
        let saturating = |j: usize, velocity: f64| {
            let term = json!({
                "model": "joint_friction", "joints": [j],
                "coulomb": {"model": "absent"}, "hysteresis": {"model": "sign"},
                "viscous": {"model": "saturating", "saturation_velocity_rad_s": velocity},
            });
            Proposal::on_joint(j, term, vec![true]).shaped(SATURATION)
        };
        (0..context.joints)
            .flat_map(|j| {
                let powers = POWERS.into_iter().map(move |p| power(j, p));
                powers.chain(SATURATION_VELOCITIES_RAD_S.into_iter().map(move |v| saturating(j, v)))
            })
            .collect()
    }

    fn parameters(&self, proposal: &Proposal, fitted: &[FittedColumn]) -> Parameters {
        let name = match proposal.fixed.get("power") {
            Some(power) => format!("viscous_{power}"),
            None => "saturation_nm".to_owned(),
        };
        let mut parameters = proposal.fixed_parameters();
        parameters.remove("power");
        if let Some((_, value, std)) = fitted.first() {
            parameters.insert(name, (json!(value), json!(std)));
        }
        parameters
    }
}
