//! Keyword arguments of calibration and diagnosis.

use aurt::{
    Settings,
    prelude::{Estimator, LoadTorqueChoice},
};
use aurt_calibration::Rest;
use pyo3::{exceptions::PyTypeError, prelude::*, types::PyDict};

use crate::{arrays::vector, error::refused};

/// All keywords, in the order of the documentation.
const KEYWORDS: [&str; 17] = [
    "f_dyn_hz",
    "sample_rate_hz",
    "position_cutoff_hz",
    "parallel_cutoff_hz",
    "rest_velocity_rad_s",
    "trim_rest",
    "count_ends",
    "max_gap_s",
    "torque_constants_nm_per_a",
    "gains",
    "offsets",
    "delay_s",
    "estimator",
    "load_torque",
    "rest",
    "fit_shapes",
    "progress",
];

/// Settings of keyword arguments, and what wants to hear of the progress.
pub fn settings<'py>(
    function: &str,
    keywords: Option<&Bound<'py, PyDict>>,
) -> PyResult<(Settings, Option<Bound<'py, PyAny>>)> {
    let (mut settings, mut progress) = (Settings::default(), None);
    for (key, value) in keywords.into_iter().flat_map(|keywords| keywords.iter()) {
        let key: String = key.extract()?;
        let number = || -> PyResult<f64> {
            value.extract().map_err(|_| PyTypeError::new_err(format!("{key} must be a number")))
        };
        let some =
            || -> PyResult<Option<f64>> { if value.is_none() { Ok(None) } else { number().map(Some) } };
        let flag = || -> PyResult<bool> {
            value.extract().map_err(|_| PyTypeError::new_err(format!("{key} must be True or False")))
        };
        let list = || -> PyResult<Option<Vec<f64>>> {
            if value.is_none() { Ok(None) } else { vector(&key, &value).map(Some) }
        };
        let Settings { preprocessing, instrument, calibration } = &mut settings;
        match key.as_str() {
            "f_dyn_hz" => preprocessing.f_dyn_hz = number()?,
            "sample_rate_hz" => preprocessing.sample_rate_hz = some()?,
            "position_cutoff_hz" => preprocessing.position_cutoff_hz = some()?,
            "parallel_cutoff_hz" => preprocessing.parallel_cutoff_hz = some()?,
            "rest_velocity_rad_s" => {
                preprocessing.rest_velocity_rad_s = number()?;
                calibration.rest_velocity_rad_s = preprocessing.rest_velocity_rad_s;
            }
            "trim_rest" => preprocessing.trim_rest = flag()?,
            "count_ends" => preprocessing.count_ends = flag()?,
            "max_gap_s" => preprocessing.max_gap_s = some()?,
            "torque_constants_nm_per_a" => instrument.torque_constants_nm_per_a = list()?,
            "gains" => instrument.gains = list()?,
            "offsets" => instrument.offsets = list()?,
            "delay_s" => instrument.delay_s = list()?,
            "estimator" => {
                calibration.estimator = choice(
                    &key,
                    &value,
                    &[
                        ("wls", Estimator::Wls),
                        ("ols", Estimator::Ols),
                        ("consistent", Estimator::Consistent),
                        ("essential", Estimator::Essential),
                        ("irls", Estimator::Irls),
                    ],
                )?;
            }
            "load_torque" => {
                let choices = [("fitted", LoadTorqueChoice::Fitted), ("literal", LoadTorqueChoice::Literal)];
                calibration.load_torque = choice(&key, &value, &choices)?;
            }
            "rest" => {
                calibration.rest = choice(&key, &value, &[("keep", Rest::Keep), ("exclude", Rest::Exclude)])?;
            }
            "fit_shapes" => calibration.fit_shapes = flag()?,
            "progress" => progress = listener(&value)?,
            _ => {
                return Err(PyTypeError::new_err(format!(
                    "{function}() has no argument `{key}`; known are {}",
                    KEYWORDS.join(", ")
                )));
            }
        }
    }
    Ok((settings, progress))
}

/// What wants to hear of the progress: a callable, `True` for lines on the standard error output.
pub fn listener<'py>(value: &Bound<'py, PyAny>) -> PyResult<Option<Bound<'py, PyAny>>> {
    if value.is_none() || value.extract::<bool>().is_ok_and(|wanted| !wanted) {
        return Ok(None);
    }
    if value.extract::<bool>().is_ok() {
        return Ok(Some(value.py().import("aurt._plain")?.getattr("say")?));
    }
    if !value.is_callable() {
        return Err(PyTypeError::new_err("progress must be True, or a function that takes a line of text"));
    }
    Ok(Some(value.clone()))
}

/// One of several words.
fn choice<T: Copy>(key: &str, value: &Bound<'_, PyAny>, choices: &[(&str, T)]) -> PyResult<T> {
    let word: String = value.extract().map_err(|_| PyTypeError::new_err(format!("{key} must be a word")))?;
    choices.iter().find(|(name, _)| *name == word).map(|(_, choice)| *choice).ok_or_else(|| {
        let names: Vec<String> = choices.iter().map(|(name, _)| format!("\"{name}\"")).collect();
        refused(format!("{key} is `{word}`; it must be one of {}", names.join(", ")))
    })
}
