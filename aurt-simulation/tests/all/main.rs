//! What the crate promises of simulations, in one program.
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

mod absurd;
mod bristles;
mod experiments;
mod integrator;
mod model;
mod robots;
