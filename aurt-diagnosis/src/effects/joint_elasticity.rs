//! `joint_elasticity`: a transmission that deforms like a spring.
//!
//! # What it is
//! Motor and link are joined by τ_J = K (θ − q) + D (θ̇ − q̇). The link then lags behind or runs ahead of the
//! motor, and the drives feel M(q) times the acceleration between the two. Well below the resonance, the torque of the
//! rigid model is off by a multiple of its second derivative, τ̈, and by the pose, in which the link hangs lower.
//!
//! - `stiffness_nm_rad`, `damping_nm_s`: K and D, of a link simulated on its gear; `frequency_hz`: √(K/M_jj)/2π. Far below the resonance
//!   K alone, in the targets alone that of a spring in series with what was there before.
//!
//! # How it shows
//! Far below the resonance: the link hangs τ_j/K lower than the motor shows, and the load of all joints is that of another pose,
//! −(∂τ/∂q_j) τ_j/K: gravity times its own slope, which no inertial parameter has. Only K follows from it.
//!
//! At 1–60 Hz: torque that the measured motion of the motor predicts through a resonator, along M e_j of the
//! joint. Encoder noise and the position filter also follow the motion, but without a phase shift; what they can
//! explain is removed first. The effect is claimed if it predicts held-out blocks of time; on a joint with such a claim the pose is not
//! looked at.
//!
//! # Easily confused with
//! - `time_delay`: follows τ̇; a resonance well above the motion delays, too.
//! - `rotor_inertia`: follows q̈, which τ̈ resembles for a single sine.
//! - noise of the acceleration: a low-pass filter resembles an elasticity of the wrong sign, so the sign is
//!   constrained.
//! - `backlash`: a link that is free within a gap, and rings on the flanks.
//! - `encoder_offset` and `spring`, where the load hardly changes.
//!
//! # What to record to be sure
//! Fast reversals at a rate of 500 Hz or more, in poses of small and large inertia: the resonance moves with
//! the inertia. Slow motion between poses in which the joint carries much and little. A sensor on the link's side shows it directly.
//!
//! # References
//! - M. W. Spong (1987), *Modeling and control of elastic joint robots*.
//! - A. De Luca, W. Book, *Robots with flexible elements*, in: Springer Handbook of Robotics.

use serde_json::json;

use crate::parameters::{FittedColumn, ParameterValue, Parameters};
use crate::vocabulary::{Context, Effect, Family, Kind, Means, OwnFriction, Parameter, Proposal, Unit};

/// Below its resonance the gear's inertial torque looks like any low-pass of the instrument, τ̈ with a positive factor: what is proposed is the
/// pose in which the link hangs alone. The rest is simulated at the recording's own rate, where the resonance turns the phase
/// (`transmission/`).
pub static EFFECT: Effect = Effect {
    id: "joint_elasticity",
    family: Family::P,
    kind: Kind::Other,
    title: "an elastic transmission",
    decider: "slow motion between poses of much and little load, and fast reversals at a rate of 500 Hz or more",
    source: include_str!("joint_elasticity.rs"),
    parameters: &[
        Parameter::new("stiffness_nm_rad", Unit::Stiffness).never_negative(),
        Parameter::new("damping_nm_s", Unit::Damping),
        Parameter::new("frequency_hz", Unit::Frequency),
    ],
    means: Means::FullRate,
    reads_model: true,
    propose,
    estimate: Some(stiffness),
    ..Effect::BASE
};

/// The gear below its resonance.
fn propose(context: &Context<'_>) -> Vec<Proposal> {
    let (columns, values): (Vec<usize>, Vec<f64>) = context.inertial.iter().copied().unzip();
    let term = |j: usize| {
        json!({
            "model": "joint_compliance", "joints": [j], "around_rad_nm": [0.0],
            "inertial_columns": columns, "inertial_values": values,
        })
    };
    (0..context.joints).map(|j| Proposal::term(vec![j], term(j)).bound(&[true])).collect()
}

/// K = 1/c; a gear that does not give way has none.
fn stiffness(_: &Proposal, fitted: &[FittedColumn], _: &OwnFriction) -> Parameters {
    let gives_way = fitted.first().filter(|(_, compliance, _)| *compliance != 0.0);
    let of = |(_, compliance, std): &FittedColumn| {
        ("stiffness_nm_rad".to_owned(), ParameterValue::new(1.0 / compliance, std / compliance.powi(2)))
    };
    gives_way.map(of).into_iter().collect()
}
