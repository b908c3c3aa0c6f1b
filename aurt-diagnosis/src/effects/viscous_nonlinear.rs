//! `viscous_nonlinear`: speed-dependent friction that is not in proportion to speed.
//!
//! # What it is
//! A power of velocity, τ = F_vp sgn(q̇) |q̇|^n, or a law that saturates, τ = F_vs tanh(q̇/v_s). Lubricant shears thin
//! as it is driven faster, so friction of harmonic drives is concave; churning and air make it convex.
//!
//! - `power_law_nm`: F_vp, Nm, the torque at 1 rad/s beside the straight line of the model, negative where friction is concave, and
//!   `velocity_exponent`: n, 1.2–3, or
//! - `saturation_nm`: F_vs ≥ 0, Nm, and `saturation_velocity_rad_s`: v_s, rad/s, usually 0.1–1.
//!
//! A change has F_vs of either sign and a straight line beside it, `viscous_nm_s`, Nm s/rad: what became less in the middle may have
//! become more at the ends.
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
//! temperature.
//!
//! # References
//! - H. Olsson, K. J. Åström, C. Canudas de Wit, M. Gäfvert, P. Lischinsky (1998), *Friction models and friction
//!   compensation*.
//! - C. Makkar, W. E. Dixon, W. G. Sawyer, G. Hu (2005), *A new continuously differentiable friction model for
//!   control systems design*.
//! - A. C. Bittencourt, S. Gunnarsson (2012), *Static friction in a robot joint – modeling and identification
//!   of load and temperature effects*.

use serde_json::json;

use crate::effects::viscous;
use crate::parameters::{FittedColumn, ParameterValue, Parameters};
use crate::vocabulary::shape::Shape;
use crate::vocabulary::{Context, Effect, Family, OwnFriction, Parameter, Proposal, Unit};

/// Exponent from which the search for the power begins: between the square and the cube, with either sign beside the straight line
/// of the model. Below 1 the column is hard to tell from dry friction; the law that saturates is there instead.
const EXPONENT: f64 = 2.5;

/// Bounds of the exponent: above 1, which the model itself has, and up to the cube.
const POWER: Shape = Shape::logarithmic("velocity_exponent", "/viscous/exponent", [1.2, 3.0], 0.25);

/// Velocities v_s from which the search for the saturating law begins. Below a quarter of a radian per second it is hard to tell
/// from dry friction.
const SATURATION_VELOCITIES_RAD_S: [f64; 3] = [0.25, 0.7, 2.0];

/// Where it is sought: up to a velocity above which the law is a straight line on any arm.
const SATURATION: Shape =
    Shape::logarithmic("saturation_velocity_rad_s", "/viscous/saturation_velocity_rad_s", [0.1, 8.0], 0.5);

pub static EFFECT: Effect = Effect {
    id: "viscous_nonlinear",
    family: Family::V,
    title: "viscous friction that is not proportional to velocity",
    decider: "constant velocities over the whole range, at constant temperature",
    source: include_str!("viscous_nonlinear.rs"),
    parameters: &[
        Parameter::new("power_law_nm", Unit::Torque),
        Parameter::new("velocity_exponent", Unit::One),
        Parameter::new("saturation_nm", Unit::Torque),
        Parameter::new("saturation_velocity_rad_s", Unit::Velocity),
        Parameter::new("viscous_nm_s", Unit::Damping),
    ],
    generalises: &[&viscous::EFFECT],
    is_essential: |coefficient| coefficient == 0,
    propose,
    estimate: Some(estimate),
    ..Effect::FRICTION
};

fn propose(context: &Context<'_>) -> Vec<Proposal> {
    let (absent, sign) = (json!({"model": "absent"}), json!({"model": "sign"}));
    let power = |j: usize| {
        let law = json!({"model": "power_law", "exponent": EXPONENT});
        Proposal::stack(j, absent.clone(), sign.clone(), law).shaped(POWER).of_all()
    };
    let saturating = |j: usize, velocity: f64| {
        let law = json!({"model": "saturating", "saturation_velocity_rad_s": velocity});
        Proposal::stack(j, absent.clone(), sign.clone(), law).bound(&[true]).shaped(SATURATION).of_all()
    };
    // The straight line of the model is that of all recordings: a change of the curve needs one of its own, and has either sign.
    let changed = |j: usize, velocity: f64| {
        let law = json!({"model": "saturating", "saturation_velocity_rad_s": velocity, "linear": true});
        Proposal::stack(j, absent.clone(), sign.clone(), law).shaped(SATURATION).of_targets()
    };
    let on = |j: usize| {
        let mut proposals = vec![power(j)];
        proposals.extend(SATURATION_VELOCITIES_RAD_S.map(|v| saturating(j, v)));
        proposals.extend(SATURATION_VELOCITIES_RAD_S.map(|v| changed(j, v)));
        proposals
    };
    (0..context.joints).flat_map(on).collect()
}

fn estimate(proposal: &Proposal, fitted: &[FittedColumn], _: &OwnFriction) -> Parameters {
    let is_power = proposal.fixed.contains_key("velocity_exponent");
    let name = if is_power { "power_law_nm" } else { "saturation_nm" };
    let mut parameters = proposal.fixed_parameters();
    if let Some((_, value, std)) = fitted.first() {
        parameters.insert(name.to_owned(), ParameterValue::new(*value, *std));
    }
    if let Some((_, value, std)) = fitted.get(1) {
        parameters.insert("viscous_nm_s".to_owned(), ParameterValue::new(*value, *std));
    }
    parameters
}
