//! `joint_elasticity`: a transmission that deforms like a spring.
//!
//! # What it is
//! Motor and link are joined by τ_J = K (θ − q) + D (θ̇ − q̇). The link then lags behind or runs ahead of the
//! motor, and the drives feel M(q) times the acceleration between the two. Well below the resonance, the torque of the
//! rigid model is only off by a multiple of its second derivative, τ̈.
//!
//! - `stiffness_nm_rad`, `damping_nm_s`: K and D, of a link simulated on its gear; `frequency_hz`: √(K/M_jj)/2π.
//!
//! A motion far below the resonance does not determine it: filters of the instrument have the same effect there.
//!
//! # How it shows
//! Torque that the measured motion of the motor predicts through a resonator, at 1–60 Hz, along M e_j of the
//! joint. Encoder noise and the position filter also follow the motion, but without a phase shift; what they can
//! explain is removed first. The effect is claimed if it predicts held-out blocks of time.
//!
//! # Easily confused with
//! - `time_delay`: follows τ̇; a resonance well above the motion delays, too.
//! - `rotor_inertia`: follows q̈, which τ̈ resembles for a single sine.
//! - noise of the acceleration: a low-pass filter resembles an elasticity of the wrong sign, so the sign is
//!   constrained.
//! - `backlash`: a link that is free within a gap, and rings on the flanks.
//!
//! # What to record to be sure
//! Fast reversals at a rate of 500 Hz or more, in poses of small and large inertia: the resonance moves with
//! the inertia. A sensor on the link's side shows it directly.
//!
//! # References
//! - M. W. Spong (1987), *Modeling and control of elastic joint robots*.
//! - A. De Luca, W. Book, *Robots with flexible elements*, in: Springer Handbook of Robotics.

use crate::vocabulary::{Effect, Family, Kind, Means, Parameter, Unit};

/// Below its resonance a gear looks like any low-pass of the instrument, τ̈ with a positive factor. It is simulated at the
/// recording's own rate, where the resonance turns the phase (`transmission/`).
pub static EFFECT: Effect = Effect {
    id: "joint_elasticity",
    family: Family::P,
    kind: Kind::Acceleration,
    title: "an elastic transmission",
    decider: "fast reversals at a rate of 500 Hz or more, with a link-side sensor if there is one",
    source: include_str!("joint_elasticity.rs"),
    parameters: &[
        Parameter::new("stiffness_nm_rad", Unit::Stiffness).never_negative(),
        Parameter::new("damping_nm_s", Unit::Damping),
        Parameter::new("frequency_hz", Unit::Frequency),
    ],
    means: Means::FullRate,
    ..Effect::BASE
};
