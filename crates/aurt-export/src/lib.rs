//! Calibrated robot models as sources and files of other programs. One target a folder.
//!
//! | target | what is made |
//! |---|---|
//! | [`c::export`] | a C99 header and source: inverse dynamics, friction, gravity, mass matrix; a program that checks them |
//! | [`mjcf::export`] | a MuJoCo model: geometry, inertias, armature, damping, friction loss |
//!
//! Each takes a [`Source`] and gives an [`Export`]: files by their names, and what the target has no word for. What cannot
//! be exported is refused by name.

pub mod c;
mod error;
pub mod mjcf;
mod naming;
mod source;

pub use error::ExportError;
pub use source::{Export, Provenance, Source};
