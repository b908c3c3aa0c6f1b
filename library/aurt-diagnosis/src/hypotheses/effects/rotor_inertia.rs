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

use serde_json::json;

use super::{Context, Effect, Family, FittedColumn, Kind, Parameters, Proposal, named};

pub(super) struct RotorInertia;

impl Effect for RotorInertia {
    fn id(&self) -> &'static str {
        "rotor_inertia"
    }

    fn family(&self) -> Family {
        Family::I
    }

    fn kind(&self) -> Kind {
        Kind::Acceleration
    }

    fn title(&self) -> &'static str {
        "inertia of the motor's rotor"
    }

    fn decider(&self) -> &'static str {
        "fast reversals of one joint at a time"
    }

    fn source(&self) -> &'static str {
        include_str!("rotor_inertia.rs")
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        (0..context.joints)
            .map(|j| Proposal::on_joint(j, json!({"model": "rotor_inertia", "joints": [j]}), vec![true]))
            .collect()
    }

    fn parameters(&self, _proposal: &Proposal, fitted: &[FittedColumn]) -> Parameters {
        named(&["inertia_kg_m2"], fitted)
    }
}
