//! Damaged inputs and interrupted commands.
#![cfg(unix)]
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

mod bench;
mod damages;
mod interrupts;
mod matrix;
mod subject;
