//! What is damaged and interrupted: the program and its commands.

use std::path::Path;

pub fn program() -> &'static Path {
    aurt()
}

/// The program that makes the files.
pub fn aurt() -> &'static Path {
    Path::new(env!("CARGO_BIN_EXE_aurt"))
}

/// A kind of input: its file, and a command that reads it and writes `out` or nothing.
#[derive(Debug, Clone, Copy)]
pub struct Input {
    pub file: &'static str,
    pub command: &'static str,
}

/// `FILE` stands for the input's file.
pub const INPUTS: [Input; 16] = [
    Input { file: "mdh.csv", command: "compile-rbd --mdh FILE --gravity 0 -9.81 0 --out out" },
    Input { file: "mdh.csv", command: "run experiment.toml --out out" },
    Input { file: "a.csv", command: "check FILE" },
    Input { file: "a.csv", command: "run experiment.toml --out out" },
    Input { file: "log.npz", command: "check FILE" },
    Input { file: "log.mat", command: "check FILE" },
    Input { file: "log.mcap", command: "check FILE" },
    Input { file: "log.parquet", command: "check FILE" },
    Input { file: "b.csv", command: "predict --model model.json --data FILE --out out" },
    Input { file: "experiment.toml", command: "run FILE --out out" },
    Input { file: "sweep.toml", command: "sweep plan FILE --out out" },
    Input { file: "scenario.toml", command: "simulate --scenario FILE --out out" },
    Input {
        file: "limits.csv",
        command: "excite --mdh mdh.csv --gravity 0 -9.81 0 --limits FILE --kind sweeps --duration-s 8 --seed 1 --out out",
    },
    Input { file: "model.json", command: "predict --model FILE --data b.csv --out out" },
    Input { file: "swept/sweep.json", command: "sweep show swept" },
    Input { file: "library.so", command: "models --plugin FILE" },
];

/// Commands of `aurt` that make what [`COMMANDS`] need.
pub const PREPARATIONS: &[&str] = &[
    "compile-rbd --mdh mdh.csv --gravity 0 -9.81 0 --out rbd.json",
    "compile-rd --model-rbd rbd.json --friction-torque-model none --friction-viscous-powers 1 --out rd.json",
];

/// A command, and whether it goes on where it was when it is run again.
pub const COMMANDS: &[(&str, bool)] = &[
    ("run experiment.toml --out out", false),
    (
        "calibrate --model rd.json --data a.csv --f-dyn-hz 5 --out-params out --out-calibrated-model sealed",
        false,
    ),
    ("diagnose experiment.toml --out out", false),
    ("excite --robot ur10e --kind sweeps --duration-s 20 --seed 1 --out out", false),
    ("sweep run sweep.toml --out out", true),
];
