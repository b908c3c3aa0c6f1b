//! What holds across the crates, in one program.
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

mod any_text;
mod corpus;
mod documentation;
mod structure;
mod unsafe_code;
