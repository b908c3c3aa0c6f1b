//! Calibrated robot models as sources and files of other programs. One target a folder.
//!
//! | target | what is made |
//! |---|---|
//! | [`c::export`] | a C99 header and source: inverse dynamics, friction with its state, gravity, mass matrix; a program that checks them |
//! | [`fmu::export`] | a functional mock-up unit: FMI 2.0 or 3.0 co-simulation of inverse or forward dynamics |
//! | [`mjcf::export`] | a MuJoCo model: geometry, inertias, armature, damping, friction loss |
//! | [`urdf::export`] | a URDF file: geometry, inertias, damping, friction |
//!
//! Each takes a [`Source`] and gives an [`Export`]: files by their names, and what the target has no word for. What cannot
//! be exported is refused by name.

pub mod c;
mod error;
pub mod fmu;
pub mod mjcf;
mod naming;
mod source;
pub mod urdf;

pub use error::ExportError;
pub use source::{Export, Provenance, Source};
