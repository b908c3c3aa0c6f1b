//! Diagnosis, and the verdicts that it gives.

use std::path::PathBuf;

use aurt::traits::RobotModel;
use aurt::{CalibratedModel, Diagnoser, Explanation, Settings};
use aurt_experiment::Experiment;
use aurt_experiment::workbench::diagnosing::{DiagnosisOptions, diagnose_experiment as diagnosed};
use aurt_experiment::workbench::failure::Failure;
use aurt_plugins::Registry;
use aurt_report::rendering::style::Style;
use aurt_report::reports::diagnosis::Diagnosed;
use aurt_report::results::verdict::Shown;
use pyo3::prelude::*;
use serde_json::{Value, json};

use crate::error::refused;
use crate::model::Model;
use crate::pickled::broken;
use crate::recording::recordings;
use crate::report::Report;
use crate::robot::Structure;
use crate::rows::{python_of, rows};
use crate::settings::{listener, with_settings};
use crate::work;

/// Answer and texts, the improved model with its lines and notes, and the report's page and title.
type PickledVerdict = ((bool, String, String), Vec<String>, Vec<String>, Model, String, String);

/// What a diagnosis found: where model and recordings differ, and what physics is missing.
#[pyclass(frozen, module = "aurt")]
pub struct Verdict {
    /// Whether something has changed or is missing.
    #[pyo3(get)]
    found: bool,
    document: Value,
    text: String,
    /// What that model has and the diagnosed one has not.
    #[pyo3(get)]
    added: Vec<String>,
    /// What a person should know about that model.
    #[pyo3(get)]
    notes: Vec<String>,
    model: CalibratedModel,
    report: Report,
}

with_settings! {
    /// Says what recordings show that a model lacks: with a target, what has changed in it; without, what is missing in the
    /// recordings that the model is calibrated on.
    ///
    /// model : Robot or Structure
    /// calibration : Recording or sequence of Recording
    ///     The machine as the model knows it.
    /// target : Recording or sequence of Recording or None
    ///     The machine in which something may have changed.
    /// validation : Recording or sequence of Recording or None
    ///     What is held out.
    diagnose(target, validation) -> Verdict = explained
}

fn explained(
    py: Python<'_>,
    model: &Bound<'_, PyAny>,
    calibration: &Bound<'_, PyAny>,
    target: Option<&Bound<'_, PyAny>>,
    validation: Option<&Bound<'_, PyAny>>,
    settings: Settings,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Verdict> {
    let structure = Structure::of(model)?;
    let reference = recordings("calibration", Some(calibration))?;
    let (target, held_out) = (recordings("target", target)?, recordings("validation", validation)?);
    if reference.is_empty() && target.is_empty() {
        return Err(refused("there is no recording to be diagnosed"));
    }
    let progress = listener(progress)?;
    work::run(py, progress.as_ref(), move |progress| {
        let mut diagnoser = Diagnoser::new(RobotModel::clone(&structure)).settings(settings);
        for recording in &reference {
            diagnoser = diagnoser.calibration(recording);
        }
        for recording in &target {
            diagnoser = diagnoser.target(recording);
        }
        for recording in &held_out {
            diagnoser = diagnoser.validation(recording);
        }
        let explanation = diagnoser.explain(progress)?;
        let document = json!(explanation.diagnosis.verdict);
        let (found, text) = (explanation.diagnosis.is_found(), Shown::of(&explanation).to_text(Style::PLAIN));
        let report = Report::of(&Diagnosed::of(&explanation, &document).page());
        let Explanation { added, notes, model, .. } = explanation;
        Ok(Verdict { found, document, text, added, notes, model, report })
    })
}

/// Diagnoses as an experiment's file says.
#[pyfunction]
#[pyo3(signature = (path, *, progress=None))]
pub fn diagnose_experiment(
    py: Python<'_>,
    path: PathBuf,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Verdict> {
    let progress = listener(progress)?;
    work::run(py, progress.as_ref(), move |progress| {
        let mut registry = Registry::of_user()?;
        let experiment = Experiment::read(&path, &mut registry)?;
        let folder = path.parent().map(PathBuf::from).unwrap_or_default();
        let options = DiagnosisOptions { improve_for: Some(folder), ..DiagnosisOptions::default() };
        let diagnosis = diagnosed(&experiment, &mut registry, &options, progress)?;
        let (found, text) = (diagnosis.is_found(), diagnosis.to_text(Style::PLAIN));
        let Some(improved) = diagnosis.improved else {
            return Err(Failure::Argument {
                option: "path",
                reason: "the experiment gives no improved model".into(),
                remedy: "diagnose it with `aurt diagnose --verdict-only`".into(),
            });
        };
        Ok(Verdict {
            found,
            document: diagnosis.document,
            text,
            added: improved.added,
            notes: improved.notes,
            model: improved.model,
            report: Report::of(&improved.report),
        })
    })
}

#[pymethods]
impl Verdict {
    /// For `pickle`: the documents, the model and the report.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, PickledVerdict)> {
        let restored = py.import("aurt._plain")?.getattr("restored_verdict")?;
        let said = (self.found, self.document.to_string(), self.text.clone());
        let (added, notes) = (self.added.clone(), self.notes.clone());
        let [html, title] = self.report.parts().map(str::to_owned);
        Ok((restored, (said, added, notes, self.model(), html, title)))
    }

    /// The verdict that `__reduce__` took apart.
    #[staticmethod]
    fn _restored(
        said: (bool, String, String),
        added: Vec<String>,
        notes: Vec<String>,
        model: &Model,
        html: String,
        title: String,
    ) -> PyResult<Self> {
        let (found, document, text) = said;
        let document = serde_json::from_str(&document).map_err(broken("verdict"))?;
        let (model, report) = (CalibratedModel::clone(&model.calibrated), Report::new(html, title));
        Ok(Self { found, document, text, added, notes, model, report })
    }

    /// The answer: "no_mismatch", "named", "partly_explained", "unexplained" or "held_out_differs".
    #[getter]
    fn answer(&self) -> &str {
        self.document["verdict"].as_str().unwrap_or_default()
    }

    /// Where there is a target, the answer about what is missing in all recordings; else None.
    #[getter]
    fn structure(&self) -> Option<&str> {
        self.document["structure"].as_str()
    }

    /// The effects as rows, strongest first.
    #[getter]
    fn effects<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.list(py, "effects")
    }

    /// What describes these recordings and fails a test, as rows.
    #[getter]
    fn indications<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.list(py, "indications")
    }

    /// Effects that these recordings can neither show nor exclude, as rows.
    #[getter]
    fn not_decidable<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.list(py, "not_decidable")
    }

    /// What is left, joint by joint, as rows.
    #[getter]
    fn residual<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.list(py, "residual")
    }

    /// The model that has what was found, calibrated.
    #[getter]
    fn model(&self) -> Model {
        Model::alone(self.model.clone())
    }

    /// All of it, as `verdict.json` has it.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        python_of(py, &self.document)
    }

    /// The report.
    fn report(&self) -> Report {
        self.report.clone()
    }

    fn _repr_html_(&self) -> String {
        self.report.notebook()
    }

    fn __str__(&self) -> &str {
        &self.text
    }

    fn __repr__(&self) -> String {
        let effects = self.document["effects"].as_array().map(Vec::as_slice).unwrap_or_default();
        let names: Vec<&str> = effects.iter().filter_map(|effect| effect["effect"].as_str()).collect();
        format!("<aurt.Verdict: {} [{}]>", self.answer(), names.join(", "))
    }
}

impl Verdict {
    fn list<'py>(&self, py: Python<'py>, key: &str) -> PyResult<Bound<'py, PyAny>> {
        rows(py, self.document[key].as_array().map(Vec::as_slice).unwrap_or_default())
    }
}
