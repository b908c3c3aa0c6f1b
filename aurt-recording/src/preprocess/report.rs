use std::path::PathBuf;

use serde::Serialize;

use crate::error::RecordingError;
use crate::preprocess::clock::ClockReport;
use crate::preprocess::options::{Decimation, PreprocessOptions};
use crate::preprocess::zero_phase::{FILTER_ORDER, ZeroPhase};
use crate::recording::Recording;
use std::fmt;

/// Everything that preprocessing found out and did, as numbers; [`Self::notes`] says it in sentences.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PreprocessReport {
    /// The recording.
    pub file: PathBuf,
    /// Samples that came in.
    pub samples: usize,
    /// Of these, samples whose values are not those of their stamp (held, repeated, leaping away for one row), which were left
    /// out; none where they were not looked for.
    pub unusable: Option<usize>,
    /// Samples that were left out since they are interpolated between others.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interpolated: Option<usize>,
    /// Its time stamps.
    pub clock: ClockReport,
    /// Rate of the grid in use, in Hz.
    pub rate_hz: f64,
    /// Whether the samples were interpolated onto that grid.
    pub resampled: bool,
    /// Gaps longer than this split the recording, in s.
    pub max_gap_s: f64,
    /// Cut-off of the position filter, in Hz.
    pub position_cutoff_hz: f64,
    /// Cut-off of the parallel filter, in Hz.
    pub parallel_cutoff_hz: f64,
    /// The decimation.
    pub decimation: Decimation,
    /// For how long both filters remember, s; see [`ZeroPhase::memory`](crate::ZeroPhase::memory).
    pub memory_s: f64,
    /// Whether rows closer than that to an end or gap at which the robot moves count.
    pub ends_count: bool,
    /// Whether rest before and after the motion was cut.
    pub trimmed_rest: bool,
    /// What is left.
    pub segments: Vec<SegmentReport>,
    /// What was left out.
    pub dropped_segments: Vec<DroppedSegment>,
    /// Per joint, the least-squares factor between the measured velocity and the one differentiated from q
    /// (1 when they agree); `None` for a joint that hardly moves or without measured velocity.
    pub velocity_scale: Vec<Option<f64>>,
}

/// A segment that is used.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SegmentReport {
    /// First row, in s from the first stamp of the recording.
    pub from_s: f64,
    /// Last sample that counts, in s from the first stamp.
    pub to_s: f64,
    /// Samples of the grid between them.
    pub samples: usize,
    /// Rows after decimation, per joint.
    pub rows: usize,
    /// Rows beside these (with [`ends_count`](PreprocessReport::ends_count), of these) that have an end or gap at which the
    /// robot moves within the filters' memory.
    pub rows_near_ends: usize,
    /// Rest that was cut before and after, in s.
    pub cut_s: [f64; 2],
}

/// A stretch between gaps that cannot be used.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DroppedSegment {
    /// First sample, in s from the first stamp of the recording.
    pub from_s: f64,
    /// Last sample, in s from the first stamp.
    pub to_s: f64,
    /// Why it was dropped.
    pub reason: String,
}

impl PreprocessReport {
    /// The filter that the positions passed.
    ///
    /// # Errors
    /// [`RecordingError::Cutoff`]; none of a report that preprocessing made.
    pub fn position_filter(&self) -> Result<ZeroPhase, RecordingError> {
        ZeroPhase::butterworth(FILTER_ORDER, self.position_cutoff_hz, self.rate_hz)
    }

    /// The report in sentences.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = vec![self.clock_note()];
        let clock = &self.clock;
        if let Some(unusable) = self.unusable.filter(|n| *n > 0) {
            notes.push(format!(
                "{unusable} of {} samples repeat older values or leap away for one row and are left out",
                self.samples
            ));
        }
        if let Some(interpolated) = self.interpolated {
            notes.push(format!(
                "{interpolated} of {} samples lie on straight lines between the others, as interpolation makes them, and are left \
                 out: deviations hold for rows as sensors give them",
                self.samples
            ));
        }
        if clock.repeated > 0 {
            notes.push(format!("{} samples repeated the one before and were merged with it", clock.repeated));
        }
        if clock.conflicting > 0 {
            notes.push(format!(
                "{} samples carried the time stamp of the one before with other values; their mean is used",
                clock.conflicting
            ));
        }
        if !clock.gaps_s.is_empty() {
            let gaps: Vec<String> =
                clock.gaps_s.iter().take(5).map(|[at, long]| format!("{long:.3} s at {at:.3} s")).collect();
            let more = if clock.gaps_s.len() > 5 { " and more" } else { "" };
            notes.push(format!(
                "{} gaps longer than {} s split the recording: {}{more}",
                clock.gaps_s.len(),
                self.max_gap_s,
                gaps.join(", ")
            ));
        }
        notes.push(format!(
            "filters: positions {} Hz, regressor and measurement {} Hz; every {}. row kept (0.8 / (4 f_dyn T_S) = {})",
            self.position_cutoff_hz,
            self.parallel_cutoff_hz,
            self.decimation.factor,
            short(self.decimation.exact)
        ));
        if self.parallel_cutoff_hz * 2.0 * self.decimation.factor as f64 > self.rate_hz {
            notes.push(format!(
                "the parallel cut-off lies above half the decimated rate ({:.3} Hz): decimation folds frequencies",
                self.rate_hz / self.decimation.factor as f64
            ));
        }
        if self.trimmed_rest {
            let [before, after] =
                self.segments.iter().fold([0.0, 0.0], |[b, a], s| [b + s.cut_s[0], a + s.cut_s[1]]);
            notes.push(format!("rest cut: {before:.3} s before and {after:.3} s after the motion"));
        }
        let near_ends: usize = self.segments.iter().map(|s| s.rows_near_ends).sum();
        if near_ends > 0 {
            let what = if self.ends_count { "are inexact" } else { "do not count" };
            notes.push(format!(
                "{near_ends} rows per joint {what}: the robot moves at an end or gap less than {:.3} s away, the filters' memory",
                self.memory_s
            ));
        }
        for dropped in &self.dropped_segments {
            notes.push(format!(
                "the stretch from {:.3} s to {:.3} s is not used: {}",
                dropped.from_s, dropped.to_s, dropped.reason
            ));
        }
        for (joint, scale) in self.velocity_scale.iter().enumerate() {
            if let Some(scale) = scale.filter(|s| (s - 1.0).abs() > 0.05) {
                notes.push(format!(
                    "the measured velocity of joint {joint} is {scale:.3} times the derivative of its position: \
                     check columns and units (positions are used, measured velocities are not)"
                ));
            }
        }
        notes
    }

    fn clock_note(&self) -> String {
        let clock = &self.clock;
        if clock.uniform && !self.resampled {
            return format!("uniform clock of {} Hz, used as it is", short(self.rate_hz));
        }
        let kind = if clock.uniform { "uniform clock" } else { "irregular clock" };
        let slower = if self.rate_hz * clock.median_period_s < 0.8 {
            "; the grid is coarser than the samples, and what lies above its Nyquist frequency folds back"
        } else {
            ""
        };
        format!(
            "{kind} (distance of stamps: median {} s, {} to {} s): resampled at {} Hz, positions by a cubic \
             spline, measurements linearly; {:.2} % of the grid lies in gaps{slower}",
            short(clock.median_period_s),
            short(clock.min_period_s),
            short(clock.max_period_s),
            short(self.rate_hz),
            100.0 * clock.missing_share
        )
    }
}

/// A number to six significant digits, without the zeros that say nothing.
fn short(value: f64) -> String {
    let digits = (5.0 - value.abs().max(f64::MIN_POSITIVE).log10().floor()).clamp(0.0, 9.0) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// Why a stretch between gaps cannot be used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Refusal {
    Short { samples: usize, needed: usize, after: &'static str },
    AtRest { joint: usize, fastest_rad_s: f64 },
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Short { samples, needed, after } => {
                write!(f, "{samples} samples{after} are too few, {needed} are needed")
            }
            Self::AtRest { .. } => write!(f, "no joint moves"),
        }
    }
}

impl Refusal {
    /// Of two refusals the one that says more about the recording as a whole.
    pub(super) fn worse(self, other: Self) -> Self {
        match (self, other) {
            (Self::Short { samples: a, .. }, Self::Short { samples: b, .. }) if b > a => other,
            (Self::Short { .. }, Self::AtRest { .. }) => other,
            (Self::AtRest { fastest_rad_s: a, .. }, Self::AtRest { fastest_rad_s: b, .. }) if b > a => other,
            _ => self,
        }
    }

    pub(super) fn into_error(self, recording: &Recording, options: &PreprocessOptions) -> RecordingError {
        let path = recording.file.clone();
        match self {
            Self::Short { samples, needed, after } => RecordingError::TooShort {
                path,
                samples,
                needed,
                after,
                remedy: "record longer, begin and end at rest, or check max_gap_s and the window".into(),
            },
            Self::AtRest { joint, fastest_rad_s } => RecordingError::AtRest {
                path,
                threshold_rad_s: options.rest_velocity_rad_s,
                joint,
                fastest_rad_s,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::short;

    #[test]
    fn numbers_have_no_idle_zeros() {
        assert_eq!([short(125.0), short(0.01), short(499.999_97)], ["125", "0.01", "500"]);
        assert_eq!([short(0.002_016), short(99.871_23), short(1e6)], ["0.002016", "99.8712", "1000000"]);
    }
}
