//! What the crate promises of diagnoses, in one program.
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

#[path = "../../src/dice.rs"]
mod dice;
mod drives;
mod effects;
mod next_drives;
mod noise;
mod real_ur10e;
mod series;
