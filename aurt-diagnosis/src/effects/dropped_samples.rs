//! `dropped_samples`: rows that are missing, repeated, held or corrupt.
//!
//! # What it is
//! The logger lost packets, wrote one twice, repeated old values of all joints or of one under new stamps, or wrote
//! invalid values. No physics of the robot is involved, but physics fitted to such rows is wrong.
//!
//! - `share`: share of the rows concerned;
//! - `missing`, `repeated`, `held`, `corrupt`: how many of each kind.
//!
//! # How it shows
//! Gaps in the time stamps; stamps or whole rows that repeat; spikes of acceleration of both signs where a held
//! position catches up. As a rule all joints are affected at the same instants.
//!
//! # Easily confused with
//! - a jittering clock: correct stamps are harmless, since samples are interpolated between them. Alternating
//!   distances of 10 and 12 ms are nothing but that.
//! - a joint at rest, whose values repeat because nothing changes.
//! - `backlash` and `external_contact`: also short, but not of the whole row.
//!
//! # What to record to be sure
//! The same motion with a logger that counts its packets. Held and corrupt rows are left out, and gaps bridged
//! or cut.
//!
//! # References
//! - R. J. A. Little, D. B. Rubin (2002), *Statistical Analysis with Missing Data*.

use crate::vocabulary::{Effect, Family, Means, Parameter, Unit};

/// Rows are checked before physics is judged, and bad ones are left out (`faults/rows.rs`).
pub static EFFECT: Effect = Effect {
    id: "dropped_samples",
    family: Family::Q,
    title: "rows that are missing, repeated, held or corrupt",
    decider: "the same motion with a logger that counts its packets",
    source: include_str!("dropped_samples.rs"),
    parameters: &[
        Parameter::new("share", Unit::One),
        Parameter::new("missing", Unit::One),
        Parameter::new("repeated", Unit::One),
        Parameter::new("held", Unit::One),
        Parameter::new("corrupt", Unit::One),
    ],
    means: Means::Samples,
    is_whole_arm: true,
    ..Effect::BASE
};
