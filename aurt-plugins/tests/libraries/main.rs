//! Dynamic libraries: a Rust and a C plugin, built and loaded; and every way in which a library can be wrong.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod built;
mod conformance;
mod errors;
mod evaluation;
mod inner;
mod saving;
