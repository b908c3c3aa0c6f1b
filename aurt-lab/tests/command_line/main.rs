//! The `aurt-lab` command as a person or a script meets it.
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

mod conceal;
mod lab;
#[path = "../programs.rs"]
mod programs;
mod proof;
mod setups;
#[path = "../../../aurt-cli/tests/command_line/support.rs"]
#[expect(dead_code, reason = "the tests of `aurt` use more of it")]
mod support;
