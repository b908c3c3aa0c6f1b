//! `current_offset`: a constant that the instrument adds to a joint's measurement.
//!
//! # What it is
//! y = τ + o: current sensors drift, and their zero is rarely recalibrated.
//!
//! - `offset`: o, in the unit of the measurement, usually below some per cent of the rated value.
//!
//! # How it shows
//! The mean of the residual is not zero, in motion and at rest alike, whatever the pose.
//!
//! # Easily confused with
//! - `coulomb_asymmetry`: the same constant while the joint moves; gone at rest.
//! - `spring`: a constant torque is a spring whose travel is small beside its preload.
//! - gravity of a joint that moves little: first moments absorb a constant there.
//!
//! # What to record to be sure
//! The measurement with the drives off or with the brakes set: what it shows then is the offset.
//!
//! # References
//! - W. Khalil, E. Dombre (2002), *Modeling, Identification and Control of Robots*.

use crate::vocabulary::{Effect, Family, Parameter, Proposal, Unit};

pub static EFFECT: Effect = Effect {
    id: "current_offset",
    family: Family::D,
    title: "a constant offset of the measurement",
    decider: "the measurement with the drives off",
    source: include_str!("current_offset.rs"),
    parameters: &[Parameter::new("offset", Unit::Measurement)],
    propose: |context| Proposal::terms(context.joints, "current_offset").collect(),
    ..Effect::BASE
};
