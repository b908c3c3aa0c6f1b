//! `torque_ripple`: a torque that repeats with the joint angle.
//!
//! # What it is
//! τ = A sin(N q + φ): magnets cog, commutation is imperfect, and the wave generator of a harmonic drive
//! deforms its teeth twice per motor turn.
//!
//! - `order`: N, cycles per turn of the joint. Twice the gear ratio for harmonic drives, gear ratio times poles
//!   for cogging: often 100–300, for direct drives as low as 1–20;
//! - `amplitude_nm`: A, 1–5 % of the rated torque.
//!
//! # How it shows
//! Against angle, the residual is a wave whose crests stay where they are, at every speed and in both
//! directions. In time its frequency is N |q̇|/2π, which rises and falls with speed and soon passes the cut-off
//! of the filters; the evidence is then in the raw recording alone.
//!
//! # Easily confused with
//! - aliasing: sampled too slowly, a fast ripple shows up at a wrong, moving frequency.
//! - `spring` and gravity, for orders of a few turns per range.
//! - `joint_elasticity`: rings at a frequency that does not change with speed.
//!
//! # What to record to be sure
//! Slow constant velocity over the joint's whole range, so slow that N |q̇|/2π stays below the filters, in both
//! directions.
//!
//! # References
//! - T. D. Tuttle, W. P. Seering (1996), *A nonlinear model of a harmonic drive gear transmission*.
//! - J. Y. Hung, Z. Ding (1993), *Design of currents to reduce torque ripple in brushless permanent magnet
//!   motors*.

use serde_json::json;

use crate::parameters::{FittedColumn, ParameterValue, Parameters};
use crate::vocabulary::periodogram::orders;
use crate::vocabulary::shape::Shape;
use crate::vocabulary::{Effect, Family, Kind, OwnFriction, Parameter, Proposal, Unit};

/// The order is sought around a peak of the periodogram, which resolves the travelled range.
const ORDER: Shape = Shape::linear("order", "/cycles_per_revolution", [1.0, 240.0], 0.15);

pub static EFFECT: Effect = Effect {
    id: "torque_ripple",
    family: Family::P,
    kind: Kind::Position,
    title: "torque ripple (a force that repeats with the joint angle)",
    decider: "slow constant velocity over the joint's whole range",
    source: include_str!("torque_ripple.rs"),
    parameters: &[Parameter::new("amplitude_nm", Unit::Torque), Parameter::new("order", Unit::One)],
    is_repeatable: true,
    reads_residual: true,
    propose: |context| {
        let of = |(joint, order): (usize, f64)| {
            let term = json!({"model": "torque_ripple", "joints": [joint], "cycles_per_revolution": order});
            Proposal::term(vec![joint], term).shaped(ORDER)
        };
        orders(context).into_iter().map(of).collect()
    },
    estimate: Some(estimate),
    ..Effect::BASE
};

fn estimate(proposal: &Proposal, fitted: &[FittedColumn], _: &OwnFriction) -> Parameters {
    let mut parameters = proposal.fixed_parameters();
    if let [(_, sine, sine_std), (_, cosine, cosine_std), ..] = fitted {
        let amplitude = sine.hypot(*cosine);
        // The deviation along the direction of the amplitude.
        let along = (sine * sine_std).hypot(cosine * cosine_std) / amplitude.max(f64::MIN_POSITIVE);
        parameters.insert("amplitude_nm".to_owned(), ParameterValue::new(amplitude, along));
    }
    parameters
}
