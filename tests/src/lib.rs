//! Tests that span several crates live in `tests/`; this library holds what they share.

pub mod any_input;
