//! Sweeps over experiments with recordings of a simulated two-link arm.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod bench;
mod definitions;
mod folders;
mod results;
