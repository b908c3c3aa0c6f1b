//! The Python package `aurt`: the library's verbs on NumPy arrays.
//!
//! | file | what |
//! |---|---|
//! | `arrays` | arrays of users, checked, as series of joints |
//! | `robot` | `Robot`, `Structure` |
//! | `recording` | `Recording` |
//! | `frames` | recordings in data frames |
//! | `model` | `calibrate`, `Model` |
//! | `diagnosis` | `diagnose`, `Verdict` |
//! | `simulation` | `simulate`, `excite` |
//! | `sweep` | `sweep`, `Sweep` |
//! | `friction` | friction models that are Python classes |
//! | `settings` | keyword arguments of calibration and diagnosis |
//! | `report` | `Report` |
//! | `work` | long work beside the interpreter |

mod arrays;
mod diagnosis;
mod error;
mod frames;
mod friction;
mod model;
mod recording;
mod report;
mod robot;
mod rows;
mod settings;
mod simulation;
mod sweep;
mod work;

/// The compiled part of the package `aurt`.
#[pyo3::pymodule]
mod _aurt {
    #[pymodule_export]
    use crate::{
        diagnosis::{Verdict, diagnose, diagnose_experiment},
        error::Error,
        model::{Model, Predictor, calibrate, calibrate_experiment},
        recording::Recording,
        report::Report,
        robot::{Robot, Structure},
        simulation::{excite, robots, simulate},
        sweep::{Swept, sweep},
    };

    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "Python's name")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
