//! How a machine has changed since its calibration.

use std::path::PathBuf;

use aurt::CalibratedModel;
use aurt_experiment::Experiment;
use aurt_experiment::workbench::failure::Failure;
use aurt_experiment::workbench::reports::track as words;
use aurt_experiment::workbench::tracking::{self, Followed, SHORTEST_WINDOW_S, TrackOptions, recordings_of};
use aurt_plugins::Registry;
use aurt_recording::RecordedAs;
use aurt_report::Page;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use serde_json::{Value, json};

use crate::error::{raised, refused};
use crate::model::Model;
use crate::recording::Recording;
use crate::report::Report;
use crate::rows::{python_of, rows};
use crate::settings::listener;
use crate::work;

/// How a machine has changed since its calibration: friction, gains and load, with alarms.
#[pyclass(frozen, module = "aurt")]
pub struct Tracking {
    document: Value,
    text: String,
    page: Page,
}

/// Follows a calibrated machine over time, as `aurt track` does. The recordings of the experiment are the unchanged machine.
///
/// experiment : path
///     The experiment's file.
/// model : Model or path
///     The model that was calibrated on it.
/// recordings : Recording, path, or sequence of these
///     In time order; a folder stands for its recordings by name.
/// window_s : float, default 5.0
///     Length of the windows that are compared with the unchanged machine, s.
/// false_alarm_h : float, default 720.0
///     Mean time of recording between two false alarms of the whole arm, h.
/// friction_half_life_s, gain_half_life_s, load_half_life_s : float, default 60.0, 120.0, 20.0
///     Time of recording after which old rows count half in the tracked estimates, s.
/// joint_names, topic
///     Of files, as for Recording.
/// progress : bool or callable or None
#[pyfunction]
#[pyo3(signature = (experiment, model, recordings, *, window_s=5.0, false_alarm_h=720.0, friction_half_life_s=60.0,
                    gain_half_life_s=120.0, load_half_life_s=20.0, joint_names=None, topic=None, progress=None))]
pub fn track(
    py: Python<'_>,
    experiment: PathBuf,
    model: &Bound<'_, PyAny>,
    recordings: &Bound<'_, PyAny>,
    window_s: f64,
    false_alarm_h: f64,
    friction_half_life_s: f64,
    gain_half_life_s: f64,
    load_half_life_s: f64,
    joint_names: Option<Vec<String>>,
    topic: Option<String>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Tracking> {
    for (name, value, least) in [
        ("window_s", window_s, SHORTEST_WINDOW_S),
        ("false_alarm_h", false_alarm_h, f64::MIN_POSITIVE),
        ("friction_half_life_s", friction_half_life_s, f64::MIN_POSITIVE),
        ("gain_half_life_s", gain_half_life_s, f64::MIN_POSITIVE),
        ("load_half_life_s", load_half_life_s, f64::MIN_POSITIVE),
    ] {
        if !(value.is_finite() && value >= least) {
            let must = if least >= 1.0 { format!("{least} or more") } else { "a positive number".into() };
            return Err(refused(format!("{name} is {value}; it must be {must}")));
        }
    }
    let options = TrackOptions {
        recorded: RecordedAs { topic, joint_names, ..RecordedAs::default() },
        window_s,
        false_alarm_h,
        half_life_s: [friction_half_life_s, gain_half_life_s, load_half_life_s],
    };
    let followed = followed(recordings)?;
    let model = match model.cast::<Model>() {
        Ok(model) => Ok(model.get().calibrated.clone()),
        Err(_) => Err(model
            .extract::<PathBuf>()
            .map_err(|_| PyTypeError::new_err("model must be an aurt.Model or the path of its file"))?),
    };
    let progress = listener(progress)?;
    work::run(py, progress.as_ref(), move |progress| {
        let mut registry = Registry::of_user()?;
        let read = Experiment::read(&experiment, &mut registry)?;
        let model = match model {
            Ok(model) => CalibratedModel::clone(&model),
            Err(path) => CalibratedModel::read(&path, &registry)?,
        };
        let tracked = tracking::track(&read, &model, &registry, &followed, options, progress, &mut |_| ())?;
        let mut document = json!(tracked);
        document["experiment"] = json!(experiment);
        let page = words::page(&tracked, &document);
        Ok::<_, Failure>(Tracking { text: words::text(&tracked), document, page })
    })
}

/// The recordings that a user gave.
fn followed(given: &Bound<'_, PyAny>) -> PyResult<Vec<Followed>> {
    let one = |item: &Bound<'_, PyAny>| -> PyResult<Option<Vec<Followed>>> {
        if let Ok(recording) = item.cast::<Recording>() {
            return Ok(Some(vec![Followed::Recording(recording.get().inner.clone())]));
        }
        let Ok(path) = item.extract::<PathBuf>() else { return Ok(None) };
        let files: Vec<Followed> =
            recordings_of(&[path]).map_err(raised)?.into_iter().map(Followed::File).collect();
        if files.iter().any(Followed::is_running) {
            return Err(refused("rows on standard input are followed by the command `aurt track` alone"));
        }
        Ok(Some(files))
    };
    if let Some(files) = one(given)? {
        return Ok(files);
    }
    let wrong = || PyTypeError::new_err("recordings must be aurt.Recordings, paths, or a list of these");
    let mut all = Vec::new();
    for item in given.try_iter().map_err(|_| wrong())? {
        all.extend(one(&item?)?.ok_or_else(wrong)?);
    }
    if all.is_empty() { Err(refused("recordings lists no recording")) } else { Ok(all) }
}

#[pymethods]
impl Tracking {
    /// Whether something has changed.
    #[getter]
    fn changed(&self) -> bool {
        self.document["alarms"].as_array().is_some_and(|alarms| !alarms.is_empty())
    }

    /// The alarms as rows, in the order in which they were certain: group, joint, parameter, rose, since_recording, since_s,
    /// certain_recording, certain_s.
    #[getter]
    fn alarms<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        rows(py, self.document["alarms"].as_array().map(Vec::as_slice).unwrap_or_default())
    }

    /// The drift as rows, one for each recording and parameter: recording, parameter, unit, joint, and what that recording
    /// alone shows, with its standard deviation.
    #[getter]
    fn drift<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
        let parameters = list(&self.document["parameters"]);
        let mut all = Vec::new();
        for recording in list(&self.document["recordings"]) {
            for (parameter, drift) in parameters.iter().zip(list(&recording["drift"])) {
                let mut row = json!({
                    "recording": recording["recording"],
                    "parameter": parameter["name"],
                    "unit": parameter["unit"],
                    "joint": parameter["joint"],
                });
                for (key, value) in drift.as_object().into_iter().flatten() {
                    row[key] = value.clone();
                }
                all.push(row);
            }
        }
        rows(py, &all)
    }

    /// What a person should know.
    #[getter]
    fn notes(&self) -> Vec<String> {
        let notes = self.document["notes"].as_array().map(Vec::as_slice).unwrap_or_default();
        notes.iter().filter_map(Value::as_str).map(str::to_owned).collect()
    }

    /// All of it, as `track.json` has it.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        python_of(py, &self.document)
    }

    /// The report.
    fn report(&self) -> Report {
        Report::of(&self.page)
    }

    fn _repr_html_(&self) -> String {
        Report::of(&self.page).notebook()
    }

    fn __str__(&self) -> &str {
        &self.text
    }

    fn __repr__(&self) -> String {
        let count = |key: &str| self.document[key].as_array().map_or(0, Vec::len);
        format!("<aurt.Tracking: {} recordings, {} alarms>", count("recordings"), count("alarms"))
    }
}
