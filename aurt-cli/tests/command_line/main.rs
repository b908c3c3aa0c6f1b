//! The `aurt` command as a person or a script meets it.
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

mod bad_experiment;
mod bad_model_file;
mod bad_recording;
mod chain;
mod checks;
mod coupled;
mod cut_recordings;
mod damage;
mod descriptions;
mod diagnosis;
mod estimators;
mod exports;
mod first_experiment;
mod gains;
mod hostile_names;
mod instruction_sets;
mod joined;
mod learnt;
mod long_recordings;
mod machine_output;
mod matrix;
#[cfg(target_os = "linux")]
mod memory;
mod model_schema;
mod motions;
mod names;
mod next;
mod outputs;
mod plugins;
mod programs;
mod real_recordings;
mod registered_models;
mod removal;
mod reports;
mod sensitivity;
mod series;
mod simulated_robots;
mod simulation;
mod snapshots;
mod support;
mod sweeps;
mod tracking;
mod words;
