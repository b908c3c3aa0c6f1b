//! Keyword arguments of calibration and diagnosis.

use aurt::Settings;
use aurt::data::Instrument;
use aurt::prelude::{Estimator, LoadTorqueChoice};
use aurt_calibration::{CalibrationOptions, Rest};
use aurt_recording::PreprocessOptions;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use crate::arrays::vector;
use crate::error::refused;

/// Settings as a user gives them.
pub struct Given<'a, 'py> {
    pub f_dyn_hz: f64,
    pub sample_rate_hz: Option<f64>,
    pub position_cutoff_hz: Option<f64>,
    pub parallel_cutoff_hz: Option<f64>,
    pub rest_velocity_rad_s: f64,
    pub trim_rest: bool,
    pub count_ends: bool,
    pub max_gap_s: Option<f64>,
    pub torque_constants_nm_per_a: Option<&'a Bound<'py, PyAny>>,
    pub gains: Option<&'a Bound<'py, PyAny>>,
    pub offsets: Option<&'a Bound<'py, PyAny>>,
    pub delay_s: Option<&'a Bound<'py, PyAny>>,
    pub estimator: &'a str,
    pub load_torque: &'a str,
    pub rest: &'a str,
    pub fit_shapes: bool,
}

impl Given<'_, '_> {
    /// The library's.
    pub fn settings(self) -> PyResult<Settings> {
        let list =
            |name, given: Option<&Bound<'_, PyAny>>| given.map(|given| vector(name, given)).transpose();
        let standard = Settings::default();
        Ok(Settings {
            preprocessing: PreprocessOptions {
                f_dyn_hz: self.f_dyn_hz,
                sample_rate_hz: self.sample_rate_hz,
                position_cutoff_hz: self.position_cutoff_hz,
                parallel_cutoff_hz: self.parallel_cutoff_hz,
                rest_velocity_rad_s: self.rest_velocity_rad_s,
                trim_rest: self.trim_rest,
                count_ends: self.count_ends,
                max_gap_s: self.max_gap_s,
                ..standard.preprocessing
            },
            instrument: Instrument {
                torque_constants_nm_per_a: list("torque_constants_nm_per_a", self.torque_constants_nm_per_a)?,
                gains: list("gains", self.gains)?,
                offsets: list("offsets", self.offsets)?,
                delay_s: list("delay_s", self.delay_s)?,
            },
            calibration: CalibrationOptions {
                estimator: choice("estimator", self.estimator, &Estimator::NAMES)?,
                load_torque: choice("load_torque", self.load_torque, &LoadTorqueChoice::NAMES)?,
                rest: choice("rest", self.rest, &Rest::NAMES)?,
                rest_velocity_rad_s: self.rest_velocity_rad_s,
                fit_shapes: self.fit_shapes,
                ..standard.calibration
            },
        })
    }
}

/// Declares a function of the package that takes a model, recordings and the settings of a calibration: what `inner` does
/// with them. The defaults are those of `[preprocess]`, `[instrument]` and `[calibration]`, which a test compares.
macro_rules! with_settings {
    ($(#[$doc:meta])* $name:ident($($own:ident),+) -> $result:ty = $inner:path) => {
        $(#[$doc])*
        ///
        /// Settings, as in an experiment under [preprocess], [instrument] and [calibration]:
        ///
        /// f_dyn_hz : float, default 10.0
        ///     Highest frequency of the robot's dynamics, Hz; the cut-offs follow from it.
        /// sample_rate_hz : float or None
        ///     Rate of the uniform grid, Hz; None: the recording's own.
        /// position_cutoff_hz, parallel_cutoff_hz : float or None
        ///     Cut-offs of the position filter (None: 5 f_dyn) and of that of regressor and measurement (None: 2 f_dyn), Hz.
        /// rest_velocity_rad_s : float, default 0.03
        ///     A joint moves while its speed is above this.
        /// trim_rest : bool, default True
        ///     Cut the rest before the first and after the last motion.
        /// count_ends : bool, default False
        ///     Count the rows within the filters' memory of ends and gaps.
        /// max_gap_s : float or None
        ///     Longer gaps split a recording, s; None: 0.1 s or ten periods.
        /// torque_constants_nm_per_a : sequence of float or None
        ///     Torque per current of each joint's drive; with them the model is in Nm.
        /// gains, offsets, delay_s : sequence of float or None
        ///     Of each joint: measured per true value, measured where the true value is zero, lag of the measurement, s.
        /// estimator : {"wls", "ols", "consistent", "essential", "irls"}, default "wls"
        /// load_torque : {"fitted", "literal"}, default "fitted"
        ///     Load of load-dependent friction: of the fitted bodies, or as in the paper.
        /// rest : {"keep", "exclude"}, default "keep"
        ///     Whether resting samples of a joint count.
        /// fit_shapes : bool, default True
        ///     Search the parameters in which models are not linear.
        /// progress : bool or callable or None
        ///     True prints the steps; a function receives each as a line of text.
        #[pyfunction]
        #[pyo3(signature = (
            model, calibration, *, $($own=None,)+ f_dyn_hz=10.0, sample_rate_hz=None, position_cutoff_hz=None,
            parallel_cutoff_hz=None, rest_velocity_rad_s=0.03, trim_rest=true, count_ends=false, max_gap_s=None,
            torque_constants_nm_per_a=None, gains=None, offsets=None, delay_s=None, estimator="wls",
            load_torque="fitted", rest="keep", fit_shapes=true, progress=None,
        ))]
        pub fn $name(
            py: Python<'_>,
            model: &Bound<'_, PyAny>,
            calibration: &Bound<'_, PyAny>,
            $($own: Option<&Bound<'_, PyAny>>,)+
            f_dyn_hz: f64,
            sample_rate_hz: Option<f64>,
            position_cutoff_hz: Option<f64>,
            parallel_cutoff_hz: Option<f64>,
            rest_velocity_rad_s: f64,
            trim_rest: bool,
            count_ends: bool,
            max_gap_s: Option<f64>,
            torque_constants_nm_per_a: Option<&Bound<'_, PyAny>>,
            gains: Option<&Bound<'_, PyAny>>,
            offsets: Option<&Bound<'_, PyAny>>,
            delay_s: Option<&Bound<'_, PyAny>>,
            estimator: &str,
            load_torque: &str,
            rest: &str,
            fit_shapes: bool,
            progress: Option<&Bound<'_, PyAny>>,
        ) -> PyResult<$result> {
            let given = $crate::settings::Given {
                f_dyn_hz, sample_rate_hz, position_cutoff_hz, parallel_cutoff_hz, rest_velocity_rad_s, trim_rest,
                count_ends, max_gap_s, torque_constants_nm_per_a, gains, offsets, delay_s, estimator, load_torque, rest,
                fit_shapes,
            };
            $inner(py, model, calibration, $($own,)+ given.settings()?, progress)
        }
    };
}
pub(crate) use with_settings;

/// What wants to hear of the progress: a callable, `True` for lines on the standard error output.
pub fn listener<'py>(value: Option<&Bound<'py, PyAny>>) -> PyResult<Option<Bound<'py, PyAny>>> {
    let Some(value) = value else { return Ok(None) };
    if let Ok(wanted) = value.extract::<bool>() {
        let say = || value.py().import("aurt._plain")?.getattr("say");
        return wanted.then(say).transpose();
    }
    if !value.is_callable() {
        return Err(PyTypeError::new_err("progress must be True, or a function that takes a line of text"));
    }
    Ok(Some(value.clone()))
}

/// One of several words.
pub fn choice<T: Copy>(key: &str, word: &str, choices: &[(&str, T)]) -> PyResult<T> {
    choices.iter().find(|(name, _)| *name == word).map(|(_, choice)| *choice).ok_or_else(|| {
        let names: Vec<String> = choices.iter().map(|(name, _)| format!("\"{name}\"")).collect();
        refused(format!("{key} is `{word}`; it must be one of {}", names.join(", ")))
    })
}
