use serde::{Deserialize, Serialize};

use crate::error::RecordingError;
use crate::preprocess::zero_phase::ZeroPhase;

/// How a recording is preprocessed (paper, section IV).
///
/// Experiments (`[preprocess]`) and model files hold this without `gains`, `offsets` and `delay_s`, which say what the
/// instrument did and have a place of their own there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PreprocessOptions {
    /// Highest frequency of the robot's dynamics, in Hz; the cut-offs follow from it.
    pub f_dyn_hz: f64,
    /// Rate of the uniform grid, in Hz. `None`: the recording's own rate.
    pub sample_rate_hz: Option<f64>,
    /// Cut-off of the position filter, in Hz. `None`: 5 f_dyn.
    pub position_cutoff_hz: Option<f64>,
    /// Cut-off of the parallel filter of regressor and measurement, in Hz. `None`: 2 f_dyn.
    pub parallel_cutoff_hz: Option<f64>,
    /// A joint moves while |q̇| is above this, in rad/s.
    pub rest_velocity_rad_s: f64,
    /// Cut the rest before the first and after the last motion (calibration does, validation does not).
    pub trim_rest: bool,
    /// Count the rows within the filters' memory of ends and gaps, and filter the regressor after cutting the rest, as the
    /// paper does. By default these rows do not count: there the filters see series that they had to continue themselves.
    #[serde(default)]
    pub count_ends: bool,
    /// Keep the motion up to ends and gaps, for predictions there; the same rows count.
    #[serde(skip)]
    pub whole_motion: bool,
    /// Longer gaps between stamps split the recording, in s. `None`: 0.1 s or ten periods, whichever is longer.
    pub max_gap_s: Option<f64>,
    /// Per joint, factors of the measurement: y = (raw − offset) · gain. Torque constants in Nm/A turn currents
    /// into torques. `None`: 1.
    #[serde(skip)]
    pub gains: Option<Vec<f64>>,
    /// Per joint, what the instrument shows at zero, in the raw unit. `None`: 0.
    #[serde(skip)]
    pub offsets: Option<Vec<f64>>,
    /// Per joint, by how much the measurement lags behind the positions, in s; it is shifted back. `None`: 0.
    #[serde(skip)]
    pub delay_s: Option<Vec<f64>>,
    /// Whether the [noise of the positions](crate::PositionNoise) is estimated, which calibration asks for.
    #[serde(skip, default = "yes")]
    pub position_noise: bool,
}

const fn yes() -> bool {
    true
}

impl Default for PreprocessOptions {
    fn default() -> Self {
        Self {
            f_dyn_hz: 10.0,
            sample_rate_hz: None,
            position_cutoff_hz: None,
            parallel_cutoff_hz: None,
            trim_rest: true,
            rest_velocity_rad_s: 0.03,
            count_ends: false,
            whole_motion: false,
            max_gap_s: None,
            gains: None,
            offsets: None,
            delay_s: None,
            position_noise: true,
        }
    }
}

impl PreprocessOptions {
    pub(crate) fn smoothed(
        &self,
        filter: &ZeroPhase,
        positions: &[Vec<f64>],
    ) -> Result<Vec<Vec<f64>>, RecordingError> {
        if self.count_ends { filter.filter_all(positions) } else { filter.filter_positions(positions) }
    }

    /// A joint's measurement with the instrument's offset and gain undone.
    pub(crate) fn corrected(&self, joint: usize, raw: &[f64]) -> Vec<f64> {
        let gain = self.gains.as_ref().map_or(1.0, |g| g[joint]);
        let offset = self.offsets.as_ref().map_or(0.0, |o| o[joint]);
        raw.iter().map(|v| (v - offset) * gain).collect()
    }

    /// The paper's defaults for dynamics up to `f_dyn_hz`.
    pub fn new(f_dyn_hz: f64) -> Self {
        Self { f_dyn_hz, ..Self::default() }
    }

    /// Options for a first look at recordings of which nothing is known but their lowest sampling rate: up to 10 Hz, rest included.
    pub fn first_look(lowest_rate_hz: f64) -> Self {
        Self { trim_rest: false, ..Self::new((50.0 * lowest_rate_hz).round().min(1e4) / 1e3) }
    }

    /// Cut-off of the position filter in use.
    pub fn effective_position_cutoff_hz(&self) -> f64 {
        self.position_cutoff_hz.unwrap_or(5.0 * self.f_dyn_hz)
    }

    /// Cut-off of the parallel filter in use.
    pub fn effective_parallel_cutoff_hz(&self) -> f64 {
        self.parallel_cutoff_hz.unwrap_or(2.0 * self.f_dyn_hz)
    }

    /// Checks every option that can be checked without a recording, and the number of joints.
    ///
    /// # Errors
    /// [`RecordingError::InvalidOption`], [`RecordingError::Count`].
    pub fn validate(&self, joints: usize) -> Result<(), RecordingError> {
        let single = [
            ("f_dyn_hz", Some(self.f_dyn_hz)),
            ("sample_rate_hz", self.sample_rate_hz),
            ("position_cutoff_hz", self.position_cutoff_hz),
            ("parallel_cutoff_hz", self.parallel_cutoff_hz),
            ("max_gap_s", self.max_gap_s),
        ];
        for (option, value) in single {
            if let Some(value) = value.filter(|v| !(v.is_finite() && *v > 0.0)) {
                return Err(RecordingError::option(option, value, "it must be a positive number"));
            }
        }
        let value = self.rest_velocity_rad_s;
        if !(value.is_finite() && value >= 0.0) {
            let remedy = "it must be zero or a positive number";
            return Err(RecordingError::option("rest_velocity_rad_s", value, remedy));
        }
        let per_joint = [("gains", &self.gains), ("offsets", &self.offsets), ("delay_s", &self.delay_s)];
        for (option, values) in per_joint {
            let Some(values) = values else { continue };
            if values.len() != joints {
                return Err(RecordingError::count(
                    format!("`{option}`, one for each joint"),
                    joints,
                    values.len(),
                ));
            }
            if let Some(value) = values.iter().copied().find(|v| !v.is_finite()) {
                return Err(RecordingError::option(
                    option,
                    value,
                    "it must be a finite number for every joint",
                ));
            }
        }
        if let Some(value) = self.gains.iter().flatten().copied().find(|g| *g == 0.0) {
            return Err(RecordingError::option("gains", value, "a gain of zero would erase the measurement"));
        }
        Ok(())
    }
}

/// The factor by which rows are thinned out after the parallel filter.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Decimation {
    /// F_DS = 0.8 / (4 f_dyn T_S), the paper's formula (section IV), before rounding.
    pub exact: f64,
    /// The factor used: `exact` rounded, at least 1.
    pub factor: usize,
}

impl Decimation {
    /// The factor for dynamics up to `f_dyn_hz` sampled every `period_s`.
    pub fn new(f_dyn_hz: f64, period_s: f64) -> Self {
        let exact = 0.8 / (4.0 * f_dyn_hz * period_s);
        // Saturates where the quotient is beyond usize; the rounded value of a finite positive number is safe.
        Self { exact, factor: (exact.round() as usize).max(1) }
    }
}
