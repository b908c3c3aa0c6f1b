use super::section::Section;

/// `[preprocess]`: from the raw recording to what is fitted (paper, section IV-A). All keys are optional.
#[derive(Debug, Clone, PartialEq)]
pub struct Preprocess {
    /// `f_dyn_hz`: the highest frequency of the robot's dynamics that the fit should see; 10 by default.
    pub f_dyn_hz: f64,
    /// `sample_rate_hz`: rate of the uniform grid that recordings are resampled onto; by default that of their stamps.
    pub sample_rate_hz: Option<f64>,
    /// `position_cutoff_hz`: cut-off of the filter of positions; by default 5 `f_dyn_hz`.
    pub position_cutoff_hz: Option<f64>,
    /// `parallel_cutoff_hz`: cut-off of the parallel filter of regressor and measurement; by default 2 `f_dyn_hz`.
    pub parallel_cutoff_hz: Option<f64>,
    /// `rest_velocity_rad_s`: a joint that is not faster than this rests; 0.03 by default.
    pub rest_velocity_rad_s: f64,
    /// `trim_rest`: whether rest at both ends of calibration recordings is cut off; true by default.
    pub trim_rest: bool,
    /// `max_gap_s`: longer gaps in the time stamps split the recording; by default 0.1 s or ten periods, whichever is longer.
    pub max_gap_s: Option<f64>,
}

impl Default for Preprocess {
    fn default() -> Self {
        Self {
            f_dyn_hz: 10.0,
            sample_rate_hz: None,
            position_cutoff_hz: None,
            parallel_cutoff_hz: None,
            rest_velocity_rad_s: 0.03,
            trim_rest: true,
            max_gap_s: None,
        }
    }
}

impl Preprocess {
    pub(super) fn read(mut section: Section<'_, '_>) -> Self {
        let default = Self::default();
        let preprocess = Self {
            f_dyn_hz: section.positive("f_dyn_hz").unwrap_or(default.f_dyn_hz),
            sample_rate_hz: section.positive("sample_rate_hz"),
            position_cutoff_hz: section.positive("position_cutoff_hz"),
            parallel_cutoff_hz: section.positive("parallel_cutoff_hz"),
            rest_velocity_rad_s: section
                .not_negative("rest_velocity_rad_s")
                .unwrap_or(default.rest_velocity_rad_s),
            trim_rest: section.boolean("trim_rest").unwrap_or(default.trim_rest),
            max_gap_s: section.positive("max_gap_s"),
        };
        section.finish();
        preprocess
    }
}
