//! Gains of the drives.

use std::path::PathBuf;

use aurt_calibration::KnownLoad;
use aurt_experiment::Experiment;
use aurt_experiment::workbench::gains::{Question, drive_gains};
use aurt_plugins::Registry;
use pyo3::prelude::*;
use serde_json::{Value, json};

use crate::error::refused;
use crate::rows::{python_of, rows};
use crate::settings::listener;
use crate::work;

/// Gains of the drives as recordings show them.
#[pyclass(frozen, module = "aurt", name = "Gains")]
pub struct DriveGains {
    document: Value,
    text: String,
}

/// Estimates the gains of the drives, as `aurt gains` does: their ratios from unloaded motion, the common factor from a load
/// of known mass. The experiment's arm term `payload` is the load.
///
/// experiment : path
///     The experiment's file.
/// mass_kg : float or None
///     Mass of the load; without it only ratios are determined.
/// mass_std_kg : float, default 0.0
///     Its standard deviation.
/// centre_of_mass_m : sequence of three floats or None
///     Centre of mass of the load in the frame of the link that carries it, if it is known.
/// expect : bool, default False
///     Only tell what the recordings determine, without estimating.
/// progress : bool or callable or None
#[pyfunction]
#[pyo3(signature = (experiment, *, mass_kg=None, mass_std_kg=0.0, centre_of_mass_m=None, expect=false, progress=None))]
pub fn gains(
    py: Python<'_>,
    experiment: PathBuf,
    mass_kg: Option<f64>,
    mass_std_kg: f64,
    centre_of_mass_m: Option<[f64; 3]>,
    expect: bool,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<DriveGains> {
    if mass_kg.is_none() && (mass_std_kg != 0.0 || centre_of_mass_m.is_some()) {
        return Err(refused("mass_std_kg and centre_of_mass_m need mass_kg, the mass of the load"));
    }
    let load = mass_kg.map(|mass_kg| KnownLoad { mass_kg, mass_std_kg, centre_of_mass_m });
    let question = if expect { Question::Expectation } else { Question::Estimate };
    let progress = listener(progress)?;
    work::run(py, progress.as_ref(), move |progress| {
        let experiment = Experiment::read(experiment, &mut Registry::of_user()?)?;
        let found = drive_gains(&experiment, load, question, progress)
            .map_err(|failure| failure.of_value_in(&experiment.path))?;
        let mut document = json!(found);
        document["is_expectation"] = json!(expect);
        Ok(DriveGains { text: found.to_text(), document })
    })
}

#[pymethods]
impl DriveGains {
    /// The gains as rows, one for each joint: decided ("gain", "ratio", "nothing"), value (over what the experiment states),
    /// std_dev, ratio (to that of the reference joint), ratio_std_dev.
    #[getter]
    fn joints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        rows(py, self.document["gains"]["joints"].as_array().map(Vec::as_slice).unwrap_or_default())
    }

    /// Joint whose gain ratios refer to.
    #[getter]
    fn reference(&self) -> Option<u64> {
        self.document["gains"]["reference"].as_u64()
    }

    /// Unit of the measurement before torque constants, "Nm" or "A".
    #[getter]
    fn measured_in(&self) -> Option<&str> {
        self.document["measured_in"].as_str()
    }

    /// Torque constants, Nm/A, where all are determined and currents were measured; else None.
    #[getter]
    fn torque_constants_nm_per_a(&self) -> Option<Vec<f64>> {
        self.list("torque_constants_nm_per_a")
    }

    /// `gains` of the instrument, where all are determined and torques were measured; else None.
    #[getter]
    fn instrument_gains(&self) -> Option<Vec<f64>> {
        self.list("instrument_gains")
    }

    /// What a person should know.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        let warnings = self.document["gains"]["warnings"].as_array().map(Vec::as_slice).unwrap_or_default();
        warnings.iter().filter_map(Value::as_str).map(str::to_owned).collect()
    }

    /// All of it, as `gains.json` has it.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        python_of(py, &self.document)
    }

    fn __str__(&self) -> &str {
        &self.text
    }

    fn __repr__(&self) -> String {
        let joints = self.document["gains"]["joints"].as_array().map_or(0, Vec::len);
        format!("<aurt.Gains: {joints} joints>")
    }
}

impl DriveGains {
    fn list(&self, key: &str) -> Option<Vec<f64>> {
        Some(self.document[key].as_array()?.iter().filter_map(Value::as_f64).collect())
    }
}
