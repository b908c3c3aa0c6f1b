//! `drive_efficiency`: transmission losses that differ between driving and being driven.
//!
//! # What it is
//! τ = η_driving |τ_J| sgn q̇ while the motor drives the load (τ_J q̇ > 0), η_driven |τ_J| sgn q̇ while the load
//! drives the motor. Worm gears are the extreme: they can hardly be driven back.
//!
//! - `driving`, `driven`: both coefficients ≥ 0, Nm/Nm, about 0.05–0.2 on harmonic drives; on top of load-dependent
//!   friction that the model has already.
//!
//! # How it shows
//! The residual differs by the sign of power τ_J q̇: lifting costs more than a symmetric loss predicts,
//! lowering less. Losses that do not differ are `load_dependent_friction`.
//!
//! # Easily confused with
//! - `torque_constant`: the odd part, (η_driving − η_driven)/2, multiplies |τ_J| sgn q̇ · sgn(τ_J q̇) = τ_J. It
//!   *is* an error of the gain; no recording without a known load tells them apart.
//! - `load_dependent_friction`: the even part. Only what is beyond both is this effect.
//!
//! # What to record to be sure
//! Lifting and lowering the same known load at the same speed, with the drive's gain known from a static
//! measurement.
//!
//! # References
//! - P. Hamon, M. Gautier, P. Garrec (2010), *Dynamic identification of robots with a dry friction model
//!   depending on load and velocity*.

use crate::effects::load_dependent_friction;
use crate::vocabulary::{Effect, Family, Kind, Parameter, Proposal, Unit};

pub static EFFECT: Effect = Effect {
    id: "drive_efficiency",
    family: Family::L,
    kind: Kind::Load,
    title: "transmission losses that differ between driving and being driven",
    decider: "lifting and lowering the same load at the same speed",
    source: include_str!("drive_efficiency.rs"),
    parameters: &[
        Parameter::new("driving", Unit::One).never_negative(),
        Parameter::new("driven", Unit::One).never_negative(),
    ],
    contrast: &[1.0, -1.0],
    reads_model: true,
    generalises: &[&load_dependent_friction::EFFECT],
    propose: |context| Proposal::terms(context.joints, "drive_efficiency").collect(),
    ..Effect::BASE
};
