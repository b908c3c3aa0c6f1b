//! What the crate promises of diagnoses, in one program.
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

#[expect(dead_code, reason = "some of it only the tests inside of the crate need")]
#[path = "../../src/dice.rs"]
mod dice;
mod drives;
mod effects;
mod noise;
mod real_ur10e;
mod series;
