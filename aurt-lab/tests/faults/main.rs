//! Damaged plans and interrupted proofs, as the tests of `aurt` damage and interrupt.
#![cfg(unix)]
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

#[path = "../../../aurt-cli/tests/faults/bench.rs"]
mod bench;
#[path = "../../../aurt-cli/tests/faults/damages.rs"]
mod damages;
#[path = "../../../aurt-cli/tests/faults/interrupts.rs"]
mod interrupts;
#[path = "../../../aurt-cli/tests/faults/matrix.rs"]
mod matrix;
#[path = "../programs.rs"]
mod programs;
mod subject;
