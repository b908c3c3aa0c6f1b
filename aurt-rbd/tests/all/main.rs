//! What the crate promises of rigid-body dynamics, in one program.
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

mod base_parameters;
mod coupled;
mod identities;
mod mdh;
mod reference;
mod robots;
mod trees;
