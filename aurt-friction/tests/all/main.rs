//! What the crate promises of its models, in one program.
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

mod arm_physics;
mod false_declarations;
mod registry;
mod textbook;
