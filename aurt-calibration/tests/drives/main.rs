//! Arms with drives: simulation, output error, what numbers stand for.
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

mod absorbed;
mod closed_loop;
