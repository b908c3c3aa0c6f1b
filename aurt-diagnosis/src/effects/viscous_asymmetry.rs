//! `viscous_asymmetry`: speed-dependent friction with another slope in each direction.
//!
//! # What it is
//! τ = F_v+ q̇ for q̇ > 0 and F_v− q̇ for q̇ < 0. Preloaded gears, lip seals and belts have more friction in one
//! direction.
//!
//! - `viscous_pos_nm_s`, `viscous_neg_nm_s`: F_v+ and F_v−, Nm s/rad, both ≥ 0. The drive axis of the EMPS test
//!   bench has about 175 and 247 (in N s/m).
//!
//! # How it shows
//! Against velocity the residual has a kink at zero: what is left beside the mean slope is (F_v+ − F_v−)/2 ·
//! |q̇|, an even function of velocity.
//!
//! # Easily confused with
//! - `current_offset` and `coulomb_asymmetry`: even in velocity, too, and at one speed the same. They do not
//!   grow with speed.
//! - centrifugal torque, which is even in velocity as well; it depends on pose and the model usually has it.
//! - `viscous_nonlinear`: odd in velocity, so motion in both directions separates them.
//!
//! # What to record to be sure
//! Several constant velocities in both directions, over the same range of angles.
//!
//! # References
//! - B. Armstrong-Hélouvry (1991), *Control of Machines with Friction*.
//! - A. Janot, M. Gautier, M. Brunot (2019), *Data set and reference models of EMPS*.

use crate::effects::viscous;
use crate::parameters::raised;
use crate::vocabulary::{Effect, Family, Parameter, Proposal, Unit};

/// Beside the model's own slope, the change in one direction may be negative.
pub static EFFECT: Effect = Effect {
    id: "viscous_asymmetry",
    family: Family::V,
    title: "viscous friction that differs by direction",
    decider: "constant velocities in both directions",
    source: include_str!("viscous_asymmetry.rs"),
    parameters: &[
        Parameter::new("viscous_pos_nm_s", Unit::Damping).never_negative(),
        Parameter::new("viscous_neg_nm_s", Unit::Damping).never_negative(),
    ],
    generalises: &[&viscous::EFFECT],
    contrast: &[1.0, -1.0],
    propose: |context| Proposal::terms(context.joints, "viscous_asymmetric").collect(),
    estimate: Some(|proposal, fitted, own| EFFECT.named(proposal, &raised(fitted, own.viscous_nm_s))),
    ..Effect::FRICTION
};
