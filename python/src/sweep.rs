//! Sweeps: variants of an experiment, fitted, judged on what they were not fitted to, and ranked.

use std::path::PathBuf;

use aurt::Progress;
use aurt_experiment::sweep::{Event, Folder, Plan, Ranking, Rows, Sweep};
use aurt_experiment::workbench::failure::Failure;
use aurt_experiment::workbench::results::sweep_table;
use aurt_plugins::Registry;
use aurt_report::rendering::style::Style;
use pyo3::prelude::*;
use serde_json::{Value, json};

use crate::error::refused;
use crate::rows::{python_of, rows as table_of};
use crate::settings::listener;
use crate::work;

/// The points of a sweep, best first.
#[pyclass(frozen, module = "aurt", name = "Sweep")]
pub struct Swept {
    ranking: Ranking,
    document: Value,
}

/// Runs the points of an experiment's section `sweep` that have no result in the folder yet, as `aurt sweep run` does, and
/// ranks all of them.
#[pyfunction]
#[pyo3(signature = (path, out, *, rows="all", progress=None))]
pub fn sweep(
    py: Python<'_>,
    path: PathBuf,
    out: PathBuf,
    rows: &str,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Swept> {
    let rows = match rows {
        "all" => Rows::All,
        "moving" => Rows::Moving,
        other => return Err(refused(format!("rows must be \"all\" or \"moving\", is \"{other}\""))),
    };
    let progress = listener(progress)?;
    let ranking = work::run(py, progress.as_ref(), move |progress| ranked(&path, &out, rows, progress))?;
    let document = json!(ranking);
    Ok(Swept { ranking, document })
}

fn ranked(
    path: &std::path::Path,
    out: &std::path::Path,
    rows: Rows,
    progress: &Progress,
) -> Result<Ranking, Failure> {
    let mut registry = Registry::of_user()?;
    let sweep = Sweep::read(path, &mut registry)?;
    let folder = Folder::for_sweep(out, &sweep)?;
    let plan = Plan::of(&sweep, &registry)?;
    folder.write_plan(&sweep, &plan)?;
    let points = plan.points.len();
    let watch = |event: Event| match event {
        Event::Begin { present } => {
            progress.step(format!("{points} points, {present} of them have their result"));
        }
        Event::Done => progress.step("a point is done"),
    };
    aurt_experiment::sweep::run(&sweep, &plan, &folder, &watch)?;
    Ok(Ranking::of(&folder, &plan, rows))
}

#[pymethods]
impl Swept {
    /// The points that could be judged, best first, as rows: rank, number, name, coefficients, shapes, score (mean squared
    /// error over that of the reference, geometric mean over the joints), tied_with_best, and nrmse_percent by joint.
    #[getter]
    fn table<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let rows: Vec<Value> = self
            .ranking
            .ranked
            .iter()
            .map(|point| {
                let errors: Vec<Option<f64>> = point.joints.iter().map(|j| j.nrmse_percent).collect();
                json!({
                    "rank": point.rank,
                    "number": point.number,
                    "name": point.name,
                    "coefficients": point.coefficients,
                    "shapes": point.shapes,
                    "score": point.score,
                    "tied_with_best": point.tied_with_best,
                    "nrmse_percent": errors,
                })
            })
            .collect();
        table_of(py, &rows)
    }

    /// The points that could not be judged, as rows, with the reasons.
    #[getter]
    fn failed<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let rows = self.document["failed"].as_array().map(Vec::as_slice).unwrap_or_default();
        table_of(py, rows)
    }

    /// The point that others are compared with.
    #[getter]
    fn reference(&self) -> Option<&str> {
        self.ranking.reference.as_deref()
    }

    /// The best point, if any could be judged.
    #[getter]
    fn best(&self) -> Option<&str> {
        self.ranking.ranked.first().map(|point| point.name.as_str())
    }

    /// All that `table.json` of `aurt sweep` holds.
    #[getter]
    fn document<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        python_of(py, &self.document)
    }

    fn __len__(&self) -> usize {
        self.ranking.ranked.len()
    }

    fn __str__(&self) -> String {
        sweep_table::to_text(&self.ranking, Style::PLAIN)
    }

    fn __repr__(&self) -> String {
        let (judged, failed) = (self.ranking.ranked.len(), self.ranking.failed.len());
        format!(
            "aurt.Sweep({judged} points judged, {failed} failed, best: {:?})",
            self.best().unwrap_or("none")
        )
    }
}
