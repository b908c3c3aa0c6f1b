//! What the crate promises of calibrations, in one program.
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

mod arm;
mod consistent;
mod coverage;
mod drives;
mod gains;
#[path = "../../examples/knocks/mod.rs"]
mod knocks;
#[path = "../../examples/known_robot/mod.rs"]
mod known_robot;
mod long;
mod position_noise;
mod recursive;
mod robust;
mod row_cache;
mod separability;
mod shape_recovery;
#[path = "../../benches/workload/mod.rs"]
mod workload;
