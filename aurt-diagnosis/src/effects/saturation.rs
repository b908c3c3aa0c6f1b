//! `saturation`: a measurement that cannot show more than a limit.
//!
//! # What it is
//! y = clamp(τ, −L, L): the current sensor, its converter or the drive itself ends at ± L, and what the joint
//! needed beyond that is lost.
//!
//! - `limit`: L, in the unit of the measurement;
//! - `share`: share of the samples that lie at the limit.
//!
//! # How it shows
//! Flat tops: the largest value of the recording returns again and again, in runs of identical samples. The
//! residual is one-sided where the torque is largest.
//!
//! # Easily confused with
//! - `torque_constant`: a fit through clipped peaks finds too small a gain.
//! - `load_dependent_friction` and `viscous_nonlinear`, which also bend the torque where it is large.
//! - coarse resolution: a slow signal in coarse steps has flat tops, too, but at heights that differ from peak
//!   to peak.
//!
//! # What to record to be sure
//! The same motion at half the speed or with half the load. The rows at the limit are left out of every fit.
//!
//! # References
//! - R. Isermann, M. Münchhof (2011), *Identification of Dynamic Systems*.

use crate::vocabulary::{Effect, Family, Means, Parameter, Unit};

/// What was clipped is lost. Clipped samples are found in the raw recording and left out (`faults/saturation.rs`).
pub static EFFECT: Effect = Effect {
    id: "saturation",
    family: Family::D,
    title: "a measurement that is clipped at a limit",
    decider: "the same motion at half the speed or with half the load",
    source: include_str!("saturation.rs"),
    parameters: &[Parameter::new("limit", Unit::Measurement), Parameter::new("share", Unit::One)],
    means: Means::Samples,
    ..Effect::BASE
};
