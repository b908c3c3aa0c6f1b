//! `rotor_inertia`: inertia of the motor's rotor.
//!
//! # What it is
//! τ = I_a q̈: the rotor turns faster than the joint by the gear ratio n, so behind the gear it weighs n² times
//! its own inertia.
//!
//! - `inertia_kg_m2`: I_a ≥ 0, 0.01–1 kg m².
//!
//! # How it shows
//! Against the joint's own acceleration, the residual is a straight line through the origin, in every pose.
//! Light wrists show it most: their links weigh less than their rotors.
//!
//! # Easily confused with
//! - the link's own moment of inertia about the joint axis: on the first joint of any arm, and on the second
//!   where the first axis is vertical, the two are *exactly* the same column. A refit of the bodies absorbs it
//!   there.
//! - `joint_elasticity` and `time_delay`, in motion of a single frequency.
//! - `joint_coupling_friction`, whose motor also follows the neighbour's acceleration.
//!
//! # What to record to be sure
//! Fast reversals of one joint at a time, in poses of small and large link inertia: the rotor's share does not
//! change.
//!
//! # References
//! - W. Khalil, E. Dombre (2002), *Modeling, Identification and Control of Robots*.

use crate::vocabulary::{Effect, Family, Kind, Parameter, Proposal, Unit};

pub static EFFECT: Effect = Effect {
    id: "rotor_inertia",
    family: Family::I,
    kind: Kind::Acceleration,
    title: "inertia of the motor's rotor",
    decider: "fast reversals of one joint at a time",
    stays_beside_delays: true,
    source: include_str!("rotor_inertia.rs"),
    parameters: &[Parameter::new("inertia_kg_m2", Unit::Inertia).never_negative()],
    propose: |context| Proposal::terms(context.joints, "rotor_inertia").map(|p| p.bound(&[true])).collect(),
    ..Effect::BASE
};
