//! What is damaged and interrupted: the program and its commands.

use std::path::Path;

pub use crate::programs::aurt;

pub fn program() -> &'static Path {
    // It runs the one beside it.
    aurt();
    crate::programs::aurt_lab()
}

/// A kind of input: its file, and a command that reads it and writes `out` or nothing.
#[derive(Debug, Clone, Copy)]
pub struct Input {
    pub file: &'static str,
    pub command: &'static str,
}

/// `FILE` stands for the input's file.
pub const INPUTS: [Input; 1] =
    [Input { file: "plan.toml", command: "conceal --plan FILE --seed 1 --cases out --sealed sealed" }];

/// Commands of `aurt` that make what [`COMMANDS`] need.
pub const PREPARATIONS: &[&str] = &[];

/// A command, and whether it goes on where it was when it is run again.
pub const COMMANDS: &[(&str, bool)] = &[
    ("conceal --plan cases.toml --seed 1 --cases out --sealed sealed", true),
    ("prove --world clean --plan proof.toml --seed 1 --out out", true),
];
