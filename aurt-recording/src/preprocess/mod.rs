//! From a recording to what calibration needs: a uniform grid, filtered motion, decimated measurement.

mod bank;
mod bank_kernel;
mod butterworth;
pub(crate) mod clock;
mod modes;
mod options;
mod report;
pub(crate) mod resample;
pub(crate) mod segment;
pub(crate) mod span;
mod spline;
mod zero_phase;

pub use bank::{DecimatedTile, ZeroPhaseBank};
pub use butterworth::Section;
pub use clock::ClockReport;
pub use options::{Decimation, PreprocessOptions};
pub use report::{DroppedSegment, PreprocessReport, SegmentReport};
pub use segment::Segment;
pub use zero_phase::ZeroPhase;

use std::ops::Range;
use std::path::Path;

use crate::branches::NOISE_SAMPLES;
use crate::error::RecordingError;
use crate::noise::PositionNoise;
use crate::preprocess::clock::Clock;
use crate::preprocess::report::Refusal;
use crate::preprocess::segment::Plan;
use crate::preprocess::zero_phase::{CUTOFF_RANGE, FILTER_ORDER};
use crate::recorded_as::TimeUnit;
use crate::recording::Recording;
use crate::sampling::stamps::LOGGED_HZ;

/// Largest decimation; it stands for a wrong f_dyn, not for a choice.
const COARSEST_DECIMATION: f64 = 1e5;

/// A recording made ready for calibration, validation or prediction.
#[derive(Debug, Clone, PartialEq)]
pub struct Preprocessed {
    /// Stretches without gaps, in order of time.
    pub segments: Vec<Segment>,
    /// What was found and done.
    pub report: PreprocessReport,
    /// Noise of each joint's positions as they were recorded, from the beginning of the recording; empty where the options do
    /// not ask for it.
    pub position_noise: Vec<PositionNoise>,
}

/// Preprocesses a recording as in section IV of the paper, after putting it on a uniform grid where it is not.
///
/// 1. Samples that share a stamp (to 5 % of the median distance) are merged; gaps split the recording, and stretches between gaps that are shorter
///    than two periods of f_dyn are dropped.
/// 2. Clock: stamps within 2 % of a period of a uniform grid are used as they are. Otherwise positions are
///    interpolated by a cubic spline, measurements linearly, onto a grid of `sample_rate_hz`, by default
///    1/median distance of stamps (the nearest common rate within 5 %).
/// 3. Instrument: y = (raw − offset) · gain, shifted back by the delay.
/// 4. q̂: 4th-order Butterworth at 5 f_dyn, forward and backward; velocities by central differences of q̂,
///    accelerations by the three-point stencil; one sample is lost at either end.
/// 5. The measurement passes the parallel filter at 2 f_dyn, and is thinned out by F_DS = 0.8 / (4 f_dyn T_S); the regressor
///    is to pass [`Segment::bank`] or [`Segment::filtered`].
/// 6. Rows count that lie further from ends and gaps than the filters [remember](ZeroPhase::memory); of a robot that stands
///    there, half as far. With `trim_rest`, only those from the first to the last sample at which any joint moves.
///
/// With `count_ends`, steps 5 and 6 are the paper's: all rows count, and with `trim_rest` the regressor passes the filter
/// after it was cut.
///
/// # Errors
/// Invalid options, a recording that is inconsistent, too short, at rest, or too slow for the cut-offs; see
/// [`RecordingError`].
pub fn preprocess(
    recording: &Recording,
    options: &PreprocessOptions,
) -> Result<Preprocessed, RecordingError> {
    recording.validate()?;
    options.validate(recording.joints())?;
    let (merged, counts) = resample::merge_repeated(recording);
    let clock = Clock::judge(&merged, options, counts)?;
    let decimation = Decimation::new(options.f_dyn_hz, 1.0 / clock.rate_hz);
    if decimation.exact > COARSEST_DECIMATION {
        let remedy =
            "so low a frequency leaves less than one row in a hundred thousand samples; give it in Hz";
        return Err(RecordingError::option("f_dyn_hz", options.f_dyn_hz, remedy));
    }
    let grid = (clock.rate_hz, clock.resample, clock.max_gap_s);
    let of = (recording.file.as_path(), recording.samples(), recording.joints());
    let (plan, mut report) = Plan::new(of, options, grid, clock.report)?;
    let origin = merged.time_s[0];
    let mut segments = Vec::new();
    let mut refusal: Option<Refusal> = None;
    let mut agreement = segment::VelocityAgreement::new(recording.joints());
    let shortest = shortest_between_gaps(options, clock.runs.len(), clock.rate_hz);
    for run in clock.runs {
        let [from_s, to_s] = [merged.time_s[run.start] - origin, merged.time_s[run.end - 1] - origin];
        let refused = too_short_between_gaps(&merged.time_s, &run, clock.rate_hz, shortest);
        let result = match refused {
            Some(refusal) => Err(refusal),
            None => plan.segment(&merged, run, &mut agreement)?,
        };
        match result {
            Ok((segment, reported)) => {
                report.segments.push(reported);
                segments.push(segment);
            }
            Err(refused) => {
                let reason = refused.to_string();
                report.dropped_segments.push(DroppedSegment { from_s, to_s, reason });
                refusal = Some(refusal.map_or(refused, |r| r.worse(refused)));
            }
        }
    }
    if segments.is_empty() {
        let refusal = refusal.unwrap_or(Refusal::Short { samples: 0, needed: 1, after: "" });
        return Err(refusal.into_error(recording, options));
    }
    report.velocity_scale = agreement.scale(options.rest_velocity_rad_s);
    let looked_at = merged.time_s.len().min(NOISE_SAMPLES);
    let noise = |q: &Vec<f64>| PositionNoise::of(&merged.time_s[..looked_at], &q[..looked_at]);
    let asked = if options.position_noise { merged.position_rad.as_slice() } else { &[] };
    let position_noise = asked.iter().map(noise).collect();
    Ok(Preprocessed { segments, report, position_noise })
}

/// Where ends count, both filters spoil about a period of f_dyn at either end; between gaps, stretches shorter than that, in
/// samples, are not worth it.
pub(crate) fn shortest_between_gaps(options: &PreprocessOptions, runs: usize, rate_hz: f64) -> usize {
    if runs > 1 && options.count_ends { (2.0 * rate_hz / options.f_dyn_hz).ceil() as usize } else { 0 }
}

fn too_short_between_gaps(time: &[f64], run: &Range<usize>, rate_hz: f64, needed: usize) -> Option<Refusal> {
    let samples = ((time[run.end - 1] - time[run.start]) * rate_hz).round() as usize + 1;
    (samples < needed).then_some(Refusal::Short { samples, needed, after: " between gaps" })
}

/// The filter of a name with the cut-off that an option has `set`, or else with that multiple of f_dyn.
pub(crate) fn filter(
    file: &Path,
    [f_dyn_hz, rate_hz]: [f64; 2],
    (name, option): (&'static str, &str),
    set: Option<f64>,
    multiple: f64,
) -> Result<ZeroPhase, RecordingError> {
    let cutoff_hz = set.unwrap_or(multiple * f_dyn_hz);
    let highest_hz = CUTOFF_RANGE[1] * rate_hz / 2.0;
    if cutoff_hz <= highest_hz {
        return ZeroPhase::butterworth(FILTER_ORDER, cutoff_hz, rate_hz);
    }
    // With default cut-offs the position filter is the first to reach the Nyquist frequency.
    let largest_f_dyn_hz = highest_hz / if set.is_some() { multiple } else { 5.0 };
    let mut remedy = if set.is_some() {
        format!("{option} can be at most {} Hz", rounded_down(highest_hz))
    } else {
        format!(
            "it is {multiple} f_dyn, so f_dyn_hz can be at most {}; three times the highest frequency of the motion is enough, \
             and arms mostly move below 1 Hz (`aurt check` names the value that suits a recording); or record faster, or set \
             {option}",
            rounded_down(largest_f_dyn_hz)
        )
    };
    if rate_hz < LOGGED_HZ[0] {
        let [low, high] = LOGGED_HZ;
        let is_logged = |unit: &TimeUnit| (low..high).contains(&(rate_hz / unit.seconds()));
        let unit = TimeUnit::NAMES
            .map(|(_, unit)| unit)
            .into_iter()
            .find(is_logged)
            .unwrap_or(TimeUnit::Millisecond)
            .key();
        remedy.push_str(&format!(
            ". So low a rate also comes from time stamps that are not in seconds: if so, write `time = \"{unit}\"` in \
             `[recordings]`"
        ));
    }
    Err(RecordingError::AboveNyquist {
        path: file.to_owned(),
        which: name,
        cutoff_hz,
        rate_hz,
        largest_f_dyn_hz,
        remedy,
    })
}

/// A frequency to three digits, never above its value, so that what is written is allowed.
fn rounded_down(frequency_hz: f64) -> f64 {
    let unit = 10.0_f64.powf(frequency_hz.abs().max(f64::MIN_POSITIVE).log10().floor() - 2.0);
    let inverse = unit.recip().round();
    if inverse >= 1.0 {
        (frequency_hz * inverse).floor() / inverse
    } else {
        (frequency_hz / unit).floor() * unit
    }
}
