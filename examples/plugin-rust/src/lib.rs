//! An example of a plugin in Rust: one model for each slot that a plugin can fill, one a file.
//!
//! - [`smooth_load::SmoothLoad`], a Coulomb level;
//! - [`stop::Stop`], a hysteresis with memory;
//! - [`eyring::Eyring`], a viscous model with a parameter in which it is not linear;
//! - [`dress_pack::DressPack`], an arm term that acts on two joints.
//!
//! Built with `cargo build --release`, the crate gives a library to be named under `[plugins]` in an experiment or after
//! `--plugin`. A program that has it among its dependencies and says `use aurt_plugin_example as _;` has the same models
//! without any library.

pub mod dress_pack;
pub mod eyring;
pub mod smooth_load;
pub mod stop;

#[cfg(feature = "library")]
aurt_traits::export_plugin!();
