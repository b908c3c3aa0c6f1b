//! `external_contact`: an external force that acts for a limited time.
//!
//! # What it is
//! A force F on a link is felt by its joint and all joints before it as τ = −Jᵀ F, J the Jacobian of the point
//! it acts on: a person, a table, a cable that catches.
//!
//! - `window_s`: start and end, s from the first stamp of the recording; `link`: the link that is touched, as
//!   far as the joints can tell;
//! - `force_n`: mean force in the base frame, N.
//!
//! # How it shows
//! The residual of several joints leaves its usual range at the same moment, in the ratios that one force on one
//! link dictates, and returns to it after some tenths of a second to some seconds. Where the motion repeats, the
//! disturbance does not.
//!
//! # Easily confused with
//! - `payload`: the same ratios, but for the whole recording.
//! - friction at reversals: also short, on one joint, and at every reversal.
//! - `dropped_samples`: shorter still, and visible in the rows themselves.
//! - a contact on a farther link: joints beyond the contact feel nothing, so a small force far out and a large
//!   one further in can look alike.
//!
//! # What to record to be sure
//! The same motion again, with nothing in reach.
//!
//! # References
//! - A. De Luca, R. Mattone (2005), *Sensorless robot collision detection and hybrid force/motion control*.
//! - S. Haddadin, A. De Luca, A. Albu-Schäffer (2017), *Robot collisions: a survey on detection, isolation, and
//!   identification*.

use crate::vocabulary::{Effect, Family, Means, Parameter, Unit};

/// A contact is no part of a model of the robot. It is searched for in the residual, by time and link (`contact/`).
pub static EFFECT: Effect = Effect {
    id: "external_contact",
    family: Family::X,
    title: "an external force for a while (contact)",
    decider: "the same motion again, with nothing in reach",
    source: include_str!("external_contact.rs"),
    parameters: &[
        Parameter::new("link", Unit::One),
        Parameter::new("force_n", Unit::Force).of(&["x", "y", "z"]),
        Parameter::new("window_s", Unit::Time).of(&["from", "to"]),
    ],
    means: Means::Windows,
    is_whole_arm: true,
    ..Effect::BASE
};
