//! What recordings are good for, and usual mistakes of a setup.

use std::path::PathBuf;
use std::sync::Arc;

use aurt_experiment::Experiment;
use aurt_experiment::doctor::checkup::{Checkup as Checked, Given, Known, Question, check as checked};
use aurt_experiment::workbench::failure::Failure;
use aurt_plugins::Registry;
use aurt_report::Page;
use aurt_report::rendering::style::Style;
use pyo3::prelude::*;
use serde_json::Value;

use crate::error::refused;
use crate::recording::recordings;
use crate::report::Report;
use crate::robot::Structure;
use crate::rows::{python_of, rows};
use crate::settings::listener;
use crate::work;

/// What a check came to: findings to be heeded before anyone calibrates on the recordings.
#[pyclass(frozen, module = "aurt")]
pub struct Checkup {
    /// Whether something should be heeded.
    #[pyo3(get)]
    found: bool,
    /// What should be heeded, in sentences.
    #[pyo3(get)]
    findings: Vec<String>,
    /// The f_dyn_hz that suits such motions, Hz.
    #[pyo3(get)]
    suitable_f_dyn_hz: Option<f64>,
    document: Value,
    text: String,
    pages: Vec<Page>,
}

impl Checkup {
    fn of(checkup: &Checked) -> Self {
        Self {
            found: checkup.has_findings(),
            findings: checkup.findings(),
            suitable_f_dyn_hz: checkup.suitable_f_dyn_hz(),
            document: checkup.to_json(),
            text: checkup.to_text(Style::PLAIN),
            pages: checkup.pages().into_iter().map(|(_, page)| page).collect(),
        }
    }
}

/// Checks recordings before anyone calibrates on them, as `aurt check` does: sampling, sensors, and, of a known robot, which
/// parameters the motions determine and which usual mistakes of a setup (units, signs, orders, gravity, tables, delays) would
/// explain the data.
///
/// recordings : Recording or sequence of Recording
///     What is to be calibrated on together.
/// robot : Robot or Structure or None
/// f_dyn_hz : float or None
///     Highest frequency of the robot's dynamics, Hz; None: 10, less for slow clocks.
/// progress : bool or callable or None
#[pyfunction]
#[pyo3(signature = (recordings, *, robot=None, f_dyn_hz=None, progress=None))]
pub fn check(
    py: Python<'_>,
    recordings: &Bound<'_, PyAny>,
    robot: Option<&Bound<'_, PyAny>>,
    f_dyn_hz: Option<f64>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Checkup> {
    let given = self::recordings("recordings", Some(recordings))?;
    if given.is_empty() {
        return Err(refused("recordings lists no recording"));
    }
    if let Some(wrong) = f_dyn_hz.filter(|f| !(f.is_finite() && *f > 0.0)) {
        return Err(refused(format!("f_dyn_hz is {wrong}; it must be a positive number")));
    }
    let bodies = robot.map(Structure::of).transpose()?.map(|model| model.rigid_body().clone());
    let progress = listener(progress)?;
    work::run(py, progress.as_ref(), move |progress| {
        progress.step("checking");
        let robot = bodies.as_ref().map_or(Known::Nothing, Known::Bodies);
        let recordings =
            given.into_iter().map(|recording| Given::Recording(Arc::clone(&recording))).collect();
        let registry = Registry::linked()?;
        Ok(Checkup::of(&checked(Question { robot, recordings, f_dyn_hz, registry: &registry })?))
    })
}

/// Checks the setup of an experiment and its recordings, as `aurt check experiment.toml` does.
#[pyfunction]
#[pyo3(signature = (path, *, f_dyn_hz=None, progress=None))]
pub fn check_experiment(
    py: Python<'_>,
    path: PathBuf,
    f_dyn_hz: Option<f64>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Checkup> {
    let progress = listener(progress)?;
    work::run(py, progress.as_ref(), move |progress| {
        let mut registry = Registry::of_user()?;
        let experiment = Experiment::read(path, &mut registry)?;
        progress.step("checking");
        let robot = Known::Experiment(&experiment);
        let question = Question { robot, recordings: Vec::new(), f_dyn_hz, registry: &registry };
        Ok::<_, Failure>(Checkup::of(&checked(question)?))
    })
}

#[pymethods]
impl Checkup {
    /// Usual mistakes that explain the data, as rows: sentence, change (what undoes it), error (that is left then); without a
    /// robot or a measurement none are looked for.
    #[getter]
    fn mistakes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        rows(py, self.document["setup"]["mistakes"].as_array().map(Vec::as_slice).unwrap_or_default())
    }

    /// All of it, as `aurt check --json` prints it.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        python_of(py, &self.document)
    }

    /// The report of each recording.
    fn reports(&self) -> Vec<Report> {
        self.pages.iter().map(Report::of).collect()
    }

    fn __str__(&self) -> &str {
        &self.text
    }

    fn __repr__(&self) -> String {
        format!("<aurt.Checkup: {} recordings, {} findings>", self.pages.len(), self.findings.len())
    }
}
