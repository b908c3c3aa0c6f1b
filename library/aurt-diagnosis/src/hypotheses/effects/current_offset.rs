//! `current_offset`: a constant that the instrument adds to a joint's measurement.
//!
//! # What it is
//! y = τ + o: current sensors drift, and their zero is rarely set again.
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

use serde_json::json;

use super::{Context, Effect, Family, FittedColumn, Parameters, Proposal, named};

pub(super) struct CurrentOffset;

impl Effect for CurrentOffset {
    fn id(&self) -> &'static str {
        "current_offset"
    }

    fn family(&self) -> Family {
        Family::D
    }

    /// A constant beside a Coulomb level is F₊ ≠ F₋ while the joint moves.
    fn same_force(&self) -> &'static [&'static str] {
        &["coulomb_asymmetry"]
    }

    fn title(&self) -> &'static str {
        "a constant offset of the measurement"
    }

    fn decider(&self) -> &'static str {
        "the measurement with the drives off"
    }

    fn source(&self) -> &'static str {
        include_str!("current_offset.rs")
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        (0..context.joints)
            .map(|j| Proposal::on_joint(j, json!({"model": "current_offset", "joints": [j]}), vec![]))
            .collect()
    }

    fn parameters(&self, _proposal: &Proposal, fitted: &[FittedColumn]) -> Parameters {
        named(&["offset"], fitted)
    }
}
