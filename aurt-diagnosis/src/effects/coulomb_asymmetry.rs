//! `coulomb_asymmetry`: dry friction of another size in each direction.
//!
//! # What it is
//! τ = F_C+ for q̇ > 0 and −F_C− for q̇ < 0. Gears, seals and belts that are preloaded on one side resist one
//! direction more than the other.
//!
//! - `coulomb_pos_nm`, `coulomb_neg_nm`: F_C+ and F_C−, Nm, both ≥ 0; they usually differ by a few per cent.
//!
//! # How it shows
//! While the joint moves, the difference is a constant, (F_C+ − F_C−)/2, on top of symmetric friction. It
//! vanishes at rest, since a resting joint has no kinetic friction.
//!
//! # Easily confused with
//! - `current_offset`: identical while the joint moves, so on recordings without rest the two are one class. An
//!   offset is also there at rest.
//! - `spring` with a constant torque, and the gravity of a joint that moves over a small range: constant there,
//!   too.
//! - `viscous_asymmetry`: grows with speed, which needs several speeds to be seen.
//!
//! # What to record to be sure
//! The current at rest, with the brakes released and with them set, beside slow motion in both directions: what
//! is there at rest with the brakes set is an offset, what only comes with motion is friction.
//!
//! # References
//! - B. Armstrong-Hélouvry (1991), *Control of Machines with Friction*.

use crate::effects::{coulomb, current_offset};
use crate::parameters::raised;
use crate::vocabulary::{Effect, Family, Parameter, Proposal, Unit};

/// Beside the model's own level, the change in one direction may be negative. F₊ ≠ F₋ beside a Coulomb level is a constant
/// while the joint moves.
pub static EFFECT: Effect = Effect {
    id: "coulomb_asymmetry",
    family: Family::F,
    title: "Coulomb friction that differs by direction",
    decider: "the current at rest, with the brakes released and with them set: an offset shows there, asymmetric friction does \
              not",
    source: include_str!("coulomb_asymmetry.rs"),
    parameters: &[
        Parameter::new("coulomb_pos_nm", Unit::Torque).never_negative(),
        Parameter::new("coulomb_neg_nm", Unit::Torque).never_negative(),
    ],
    generalises: &[&coulomb::EFFECT],
    contrast: &[1.0, -1.0],
    same_force: &[&current_offset::EFFECT],
    propose: |context| Proposal::terms(context.joints, "coulomb_asymmetric").collect(),
    estimate: Some(|proposal, fitted, own| EFFECT.named(proposal, &raised(fitted, own.coulomb_nm))),
    ..Effect::FRICTION
};
