//! The Python package `aurt`: the library's verbs on NumPy arrays.
//!
//! | file | what |
//! |---|---|
//! | `arrays` | arrays of users, checked, as series of joints |
//! | `robot` | `Robot`, `Structure` |
//! | `recording` | `Recording` |
//! | `frames` | recordings in data frames |
//! | `model`, `predictor` | `calibrate`, `Model`, `Predictor` |
//! | `export` | models for other programs |
//! | `check` | `check`, `Checkup` |
//! | `tracking` | `track`, `Tracking` |
//! | `gains` | `gains`, `Gains` |
//! | `diagnosis` | `diagnose`, `Verdict` |
//! | `simulation` | `simulate`, `excite` |
//! | `sweep` | `sweep`, `Sweep` |
//! | `friction` | friction models that are Python classes |
//! | `command` | the command `aurt` |
//! | `settings` | keyword arguments of calibration and diagnosis |
//! | `report` | `Report` |
//! | `work` | long work beside the interpreter |

mod arrays;
mod check;
mod command;
mod diagnosis;
mod error;
mod export;
mod frames;
mod friction;
mod gains;
mod model;
mod pickled;
mod predictor;
mod recording;
mod report;
mod robot;
mod rows;
mod settings;
mod simulation;
mod sweep;
mod tracking;
mod work;

/// The compiled part of the package `aurt`.
#[pyo3::pymodule]
mod _aurt {
    use pyo3::types::{PyAnyMethods, PyModule};
    use pyo3::{Bound, PyResult};

    #[pymodule_export]
    use crate::{
        check::{Checkup, check, check_experiment},
        command::main,
        diagnosis::{Verdict, diagnose, diagnose_experiment},
        error::Error,
        export::Exported,
        gains::{DriveGains, gains},
        model::{Model, calibrate, calibrate_experiment},
        predictor::Predictor,
        recording::Recording,
        report::Report,
        robot::{Robot, Structure},
        simulation::{excite, robots, simulate},
        sweep::{Swept, sweep},
        tracking::{Tracking, track},
    };

    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "Python's name")]
    const __version__: &str = env!("CARGO_PKG_VERSION");

    /// Names the file of this code for the keys of sweeps.
    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        aurt_experiment::sweep::code_is_in(module.getattr("__file__")?.extract()?);
        Ok(())
    }
}
