//! Calibrated robot models as sources and files of other programs. One target a folder.
//!
//! | target | what is made |
//! |---|---|
//! | [`c::export`] | a C99 header and source: inverse dynamics, friction with its state, gravity, mass matrix; a program that checks them |
//! | [`fmu::export`] | a functional mock-up unit: FMI 2.0 co-simulation of inverse or forward dynamics |
//! | [`isaac::export`] | actuators of drives for Isaac Lab, a Python file |
//! | [`mjcf::export`] | a MuJoCo model: geometry, inertias, armature, damping, friction loss |
//! | [`into::correct`] | the user's own MuJoCo or URDF file with its dynamics corrected, all else as it is |
//! | [`sdf::export`] | an SDF file for Gazebo: geometry, inertias, damping, friction, springs |
//! | [`rust::export`] | a Rust crate of the same functions, `no_std` where wanted; a test that checks them |
//! | [`urdf::export`] | a URDF file: geometry, inertias, damping, friction |
//!
//! Each takes a [`Source`] and gives an [`Export`]: files by their names, and what the target has no word for. What cannot
//! be exported is refused by name.

pub mod c;
mod error;
pub mod fmu;
pub mod into;
pub mod isaac;
pub mod mjcf;
mod naming;
mod program;
pub mod rust;
pub mod sdf;
mod source;
pub mod urdf;

pub use error::ExportError;
pub use program::Check;
pub use source::{Export, Provenance, Source, is_export};
