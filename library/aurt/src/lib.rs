//! Model, calibrate and explain the dynamics of robot manipulators from recordings of the real machine.
//!
//! | verb | with files | in memory |
//! |---|---|---|
//! | read | [`Experiment::read`](prelude::Experiment), [`Recording::read`](prelude::Recording) | [`Recording::from_arrays`](prelude::Recording::from_arrays), [`Robot::from_mdh`] |
//! | calibrate | [`calibrate`] | [`Calibrator`] |
//! | predict | [`CalibratedModel::load`], [`save`](CalibratedModel::save) | [`CalibratedModel::torque`], [`predict`](CalibratedModel::predict), sample by sample [`Predictor`] |
//! | diagnose | [`diagnose`] | [`Diagnoser`] |
//! | simulate | | [`simulate`] |
//! | report | | [`report`] |
//!
//! ```
//! use aurt::prelude::*;
//!
//! // A simulated robot stands for the real one: it moves, and its logger records.
//! let machine = robots::two_link();
//! let motion = Motion::MultiSine { duration_s: 10.0, harmonics: 6, top_hz: 1.0, share: 0.6 };
//! let recording = simulate(&Scenario::new(machine.clone(), motion.plan(&machine, 1)?, 1))?;
//!
//! let robot = Robot::from_mdh(&machine.mdh_csv(), machine.gravity_m_s2)?;
//! let outcome = Calibrator::new(robot.model().build()?).calibration(&recording).calibrate()?;
//! let model = outcome.calibrated;
//! let mut predictor = model.predictor()?;
//! let torque = predictor.torque(0.0, &[0.1, 0.2], &[0.0, 0.0], &[0.0, 0.0])?;
//! assert_eq!(torque.len(), 2);
//! # Ok::<(), aurt::Error>(())
//! ```
//!
//! Every fallible function returns one [`Error`]. Joints count from 0, units are SI and stand in names; a model calibrated
//! on motor currents has A in the place of Nm. The modules below are what the command `aurt` is made of. Traits
//! for models of one's own are in [`traits`]; [`plugins`] loads them from libraries.

pub mod calibrated_file;
pub mod calibrating;
pub mod data;
pub mod demo;
pub mod described_model;
pub mod diagnoser;
pub mod diagnosing;
pub mod doctor;
pub mod exporting;
mod failure;
pub mod first_experiment;
pub mod fitting;
pub mod gains;
pub mod glossary;
pub mod injected;
pub mod inspection;
pub mod origins;
pub mod output;
pub mod predictor;
pub mod prelude;
pub mod progress;
pub mod rendering;
pub mod reports;
pub mod results;
pub mod robot;
pub mod sensitivity;
pub mod simulated;
mod simulating;
pub mod streaming;
pub mod sweeping;
pub mod table_file;
mod torque;
pub mod tracking;

use aurt_diagnosis::Verdict;
use aurt_experiment::{Experiment, Registry};
pub use aurt_plugins as plugins;
use aurt_report::Page;
pub use aurt_simulation as simulation;
pub use aurt_traits as traits;

pub use crate::{
    calibrated_file::CalibratedModel,
    calibrating::{Calibrator, Settings},
    described_model::{ChainEnds, GivenModel},
    diagnoser::{Diagnoser, Explanation},
    diagnosing::{Diagnosis, DiagnosisOptions},
    failure::Failure as Error,
    fitting::Outcome,
    predictor::Predictor,
    progress::Progress,
    robot::{ModelBuilder, Robot},
    simulating::{Drive, simulate},
    torque::TorqueSeries,
};

/// Calibrates and judges a model as an experiment says.
///
/// # Errors
/// What makes a recording unfit or the fit impossible.
pub fn calibrate(experiment: &Experiment) -> Result<Outcome, Error> {
    fitting::fit_experiment(experiment, &Progress::silent())
}

/// Says where an experiment's model and its recordings differ and what physics is missing. More than the verdict (the
/// improved model, the report) comes from [`diagnosing::diagnose_experiment`].
///
/// # Errors
/// What makes a recording unfit, and what the diagnosis reports.
pub fn diagnose(experiment: &Experiment, registry: &mut Registry) -> Result<Verdict, Error> {
    let options = DiagnosisOptions::default();
    Ok(diagnosing::diagnose_experiment(experiment, registry, &options, &Progress::silent())?.verdict)
}

/// The report of a calibration: one self-contained HTML page.
#[must_use]
pub fn report(outcome: &Outcome) -> Page {
    let Outcome { calibrated, recordings, .. } = outcome;
    let results = results::metrics::Results {
        model: &calibrated.model,
        calibration: &calibrated.calibration,
        notes: &[],
        recordings,
    };
    reports::calibration::page("calibrate", &results, None, &results.to_json())
}
