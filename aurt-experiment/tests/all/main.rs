//! What the crate promises of experiments, in one program.
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

mod any_text;
mod experiment;
mod explained;
mod sweep;
mod workbench;
