//! Sweeps over experiments with recordings of a simulated two-link arm.

mod bench;
mod definitions;
mod folders;
mod results;
