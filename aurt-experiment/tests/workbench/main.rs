//! Experiments with a `[drive]`.
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

mod drives;
mod second_opinion;
