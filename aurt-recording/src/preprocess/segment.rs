use std::ops::Range;
use std::path::Path;

use aurt_traits::Motion;

use crate::error::RecordingError;
use crate::preprocess::bank::ZeroPhaseBank;
use crate::preprocess::clock::ClockReport;
use crate::preprocess::filter;
use crate::preprocess::options::{Decimation, PreprocessOptions};
use crate::preprocess::report::{PreprocessReport, Refusal, SegmentReport};
use crate::preprocess::resample::{grid, linear, smooth};
use crate::preprocess::span::{Memory, inner_acceleration, velocity};
use crate::preprocess::zero_phase::ZeroPhase;
use crate::recording::Recording;

/// A stretch of a recording without gaps, ready for a regressor.
///
/// It has only rows that count. The motion goes beyond them at both ends by what the parallel filter remembers, where the
/// recording does: [`Self::bank`] and [`Self::filtered`] filter over all of it and give the rows alone.
#[derive(Debug, Clone, PartialEq)]
pub struct Segment {
    /// The filtered motion on the uniform grid.
    pub motion: Motion,
    /// The measurement after the parallel filter and decimation, `[joint][row]`.
    pub measurement: Option<Vec<Vec<f64>>>,
    /// The measurement on the motion's grid, unfiltered, `[joint][sample]`.
    pub raw_measurement: Option<Vec<Vec<f64>>>,
    /// Rate of the grid, in Hz.
    pub rate_hz: f64,
    /// Every how many samples a row is kept.
    pub decimation: usize,
    /// The filter that the measurement passed, and regressors pass.
    pub parallel_filter: ZeroPhase,
    /// The rows that count among all that the parallel filter gives over the motion; see [`Self::sample`].
    pub kept_rows: Range<usize>,
    /// The samples of each joint that are [left out](Self::leave_out), `[joint][sample]`.
    pub left_out: Option<Vec<Vec<bool>>>,
}

impl Segment {
    /// Rows per joint.
    pub fn rows(&self) -> usize {
        self.kept_rows.len()
    }

    /// The sample of the motion to which a row belongs.
    pub const fn sample(&self, row: usize) -> usize {
        (self.kept_rows.start + row) * self.decimation
    }

    /// What a series over the motion is at the rows.
    pub fn at_rows(&self, series: &[f64]) -> Vec<f64> {
        (0..self.rows()).map(|row| series[self.sample(row)]).collect()
    }

    /// The rows of series over the motion, behind the parallel filter.
    ///
    /// # Errors
    /// As [`ZeroPhase::filter_all`].
    pub fn filtered<S: AsRef<[f64]>>(&self, series: &[S]) -> Result<Vec<Vec<f64>>, RecordingError> {
        Ok(self.parallel_filter.filter_all(series)?.iter().map(|s| self.at_rows(s)).collect())
    }

    /// Leaves samples of joints, `[joint][sample]`, out of the rows, or none: of the measurement here, and of columns by
    /// [`Self::silence`].
    ///
    /// Measurement and columns are zero there before they are filtered. A row is a sum over samples; what holds for each of
    /// those that are left holds for their sum, whatever the others are. A row that leaves them out after the filter would be
    /// one without a good part of its neighbours, too.
    ///
    /// # Errors
    /// As [`ZeroPhase::filter_all`].
    pub fn leave_out(&mut self, samples: Option<Vec<Vec<bool>>>) -> Result<(), RecordingError> {
        self.left_out = samples;
        let Some(mut raw) = self.raw_measurement.clone() else { return Ok(()) };
        (0..raw.len()).for_each(|joint| self.silence(joint, 0, &mut raw[joint]));
        self.measurement = Some(self.filtered(&raw)?);
        Ok(())
    }

    /// Sets a part of a joint's series, which begins at the sample `first`, to zero where samples are left out.
    pub fn silence(&self, joint: usize, first: usize, series: &mut [f64]) {
        let Some(left_out) = &self.left_out else { return };
        let of_joint = left_out[joint][first..].iter();
        series.iter_mut().zip(of_joint).filter(|(_, out)| **out).for_each(|(value, _)| *value = 0.0);
    }

    /// The parallel filter for columns over the motion that are still being made; it hands out the rows.
    pub fn bank(&self, columns: usize) -> ZeroPhaseBank {
        ZeroPhaseBank::new(&self.parallel_filter, columns, self.decimation).keeping(self.kept_rows.clone())
    }
}

/// That no joint moves, and which is the fastest.
fn at_rest(velocities: &[Vec<f64>]) -> Refusal {
    let fastest = velocities
        .iter()
        .map(|v| v[1..v.len() - 1].iter().fold(0.0_f64, |m, x| m.max(x.abs())))
        .enumerate()
        .max_by(|a, b| a.1.total_cmp(&b.1));
    let (joint, fastest_rad_s) = fastest.unwrap_or((0, 0.0));
    Refusal::AtRest { joint, fastest_rad_s }
}

/// Sums for the factor between measured and differentiated velocity.
pub(super) struct VelocityAgreement {
    sums: Vec<[f64; 3]>,
}

impl VelocityAgreement {
    pub(super) fn new(joints: usize) -> Self {
        Self { sums: vec![[0.0; 3]; joints] }
    }

    fn add(&mut self, joint: usize, measured: &[f64], derived: &[f64]) {
        let [cross, power, count] = &mut self.sums[joint];
        for (m, d) in measured.iter().zip(derived) {
            *cross += m * d;
            *power += d * d;
            *count += 1.0;
        }
    }

    /// Per joint, measured / derived; `None` where the root mean square speed is below `rest_rad_s`.
    pub(super) fn scale(&self, rest_rad_s: f64) -> Vec<Option<f64>> {
        self.sums
            .iter()
            .map(|[cross, power, count]| (*power > count * rest_rad_s * rest_rad_s).then(|| cross / power))
            .collect()
    }
}

/// Settings that all segments of a recording share.
#[derive(Debug)]
pub(crate) struct Plan {
    pub(crate) options: PreprocessOptions,
    pub(crate) rate_hz: f64,
    /// Whether samples are interpolated onto a grid of that rate.
    pub(crate) resample: bool,
    pub(crate) decimation: usize,
    pub(crate) position_filter: ZeroPhase,
    pub(crate) parallel_filter: ZeroPhase,
}

/// A run of samples on the grid, before filtering.
struct OnGrid {
    time_s: Vec<f64>,
    position_rad: Vec<Vec<f64>>,
    velocity_rad_s: Option<Vec<Vec<f64>>>,
    measurement: Option<Vec<Vec<f64>>>,
}

impl Plan {
    /// The filters for a grid of a rate, and the report on a recording, without segments.
    pub(crate) fn new(
        recording: (&Path, usize, usize),
        options: &PreprocessOptions,
        (rate_hz, resample, max_gap_s): (f64, bool, f64),
        clock: ClockReport,
    ) -> Result<(Self, PreprocessReport), RecordingError> {
        let (file, samples, joints) = recording;
        let decimation = Decimation::new(options.f_dyn_hz, 1.0 / rate_hz);
        let rates_hz = [options.f_dyn_hz, rate_hz];
        let (position, parallel) =
            (("position filter's", "position_cutoff_hz"), ("parallel filter's", "parallel_cutoff_hz"));
        let plan = Self {
            options: options.clone(),
            rate_hz,
            resample,
            decimation: decimation.factor,
            position_filter: filter(file, rates_hz, position, options.position_cutoff_hz, 5.0)?,
            parallel_filter: filter(file, rates_hz, parallel, options.parallel_cutoff_hz, 2.0)?,
        };
        let report = PreprocessReport {
            file: file.to_owned(),
            samples,
            unusable: None,
            interpolated: None,
            clock,
            rate_hz,
            resampled: resample,
            max_gap_s,
            position_cutoff_hz: plan.position_filter.cutoff_hz(),
            parallel_cutoff_hz: plan.parallel_filter.cutoff_hz(),
            decimation,
            memory_s: plan.memory().of_rows_s(rate_hz),
            ends_count: options.count_ends,
            trimmed_rest: options.trim_rest,
            segments: Vec::new(),
            dropped_segments: Vec::new(),
            velocity_scale: vec![None; joints],
        };
        Ok((plan, report))
    }

    pub(super) fn segment(
        &self,
        recording: &Recording,
        run: Range<usize>,
        agreement: &mut VelocityAgreement,
    ) -> Result<Result<(Segment, SegmentReport), Refusal>, RecordingError> {
        let padding = self.padding();
        let data = self.on_grid(recording, run);
        let n = data.time_s.len();
        // One sample is lost at either end, and the regressor has to fit the parallel filter.
        let needed = padding + 3;
        if n < needed {
            return Ok(Err(Refusal::Short { samples: n, needed, after: "" }));
        }
        let period_s = 1.0 / self.rate_hz;
        let filtered = self.options.smoothed(&self.position_filter, &data.position_rad)?;
        let velocities: Vec<Vec<f64>> = filtered.iter().map(|q| velocity(q, period_s)).collect();
        // From here on, indices count the n − 2 samples that have an acceleration.
        let inner = n - 2;
        let moving = self.moving(&velocities, inner);
        if moving.is_none() && self.options.trim_rest {
            return Ok(Err(at_rest(&velocities)));
        }
        let span = self.memory().span(&self.options, inner, moving);
        if let Some(refusal) = span.refused(padding) {
            return Ok(Err(refusal));
        }
        let kept = span.motion.clone();
        if let Some(measured) = &data.velocity_rad_s {
            for (joint, measured) in measured.iter().enumerate() {
                agreement.add(joint, &measured[1..=inner], &velocities[joint][1..=inner]);
            }
        }
        // Motion sample k is grid sample kept.start + 1 + k.
        let on_motion = kept.start + 1..kept.end + 1;
        let mut position = Vec::with_capacity(filtered.len() * kept.len());
        let mut speed = Vec::with_capacity(filtered.len() * kept.len());
        let mut acceleration = Vec::with_capacity(filtered.len() * kept.len());
        for (q, v) in filtered.iter().zip(&velocities) {
            position.extend_from_slice(&q[on_motion.clone()]);
            speed.extend_from_slice(&v[on_motion.clone()]);
            acceleration.extend(inner_acceleration(&q[kept.start..kept.end + 2], period_s));
        }
        let time_s = data.time_s[on_motion.clone()].to_vec();
        let motion = Motion::new(filtered.len(), time_s, position, speed, acceleration)
            .map_err(|_| RecordingError::count("values of the motion", filtered.len() * kept.len(), 0))?;

        let measurement = match &data.measurement {
            Some(series) => Some(
                self.parallel_filter
                    .filter_all(series)?
                    .iter()
                    .map(|s| &s[span.rows.start + 1..span.rows.end + 1])
                    .map(|rows| rows.iter().step_by(self.decimation).copied().collect())
                    .collect(),
            ),
            None => None,
        };
        let raw_measurement = data
            .measurement
            .map(|series| series.into_iter().map(|s| s[on_motion.clone()].to_vec()).collect());
        let segment = Segment {
            motion,
            measurement,
            raw_measurement,
            rate_hz: self.rate_hz,
            decimation: self.decimation,
            parallel_filter: self.parallel_filter.clone(),
            kept_rows: span.kept_rows(),
            left_out: None,
        };
        Ok(Ok((segment, span.reported(data.time_s[0] - recording.time_s[0], self.rate_hz))))
    }

    /// First and last of the `inner` samples at which a joint moves.
    fn moving(&self, velocities: &[Vec<f64>], inner: usize) -> Option<[usize; 2]> {
        let threshold = self.options.rest_velocity_rad_s;
        let moves = |k: &usize| velocities.iter().any(|v| v[k + 1].abs() > threshold);
        Some([(0..inner).find(moves)?, (0..inner).rfind(moves)?])
    }

    pub(crate) fn padding(&self) -> usize {
        self.position_filter.padding().max(self.parallel_filter.padding())
    }

    pub(crate) fn memory(&self) -> Memory {
        Memory::of(&self.position_filter, &self.parallel_filter, self.decimation)
    }

    /// The samples `run` on the uniform grid, with the instrument's gains, offsets and delays undone.
    fn on_grid(&self, recording: &Recording, run: Range<usize>) -> OnGrid {
        let time = &recording.time_s[run.clone()];
        let delays = self.options.delay_s.as_deref().unwrap_or(&[]);
        let delayed = delays.iter().any(|d| *d != 0.0);
        // Shifting the measurement back leaves nothing to look up at one end; that end is cut.
        let from_s = time[0] - delays.iter().copied().fold(0.0, f64::min);
        let to_s = time[time.len() - 1] - delays.iter().copied().fold(0.0, f64::max);
        let own = time.partition_point(|t| *t < from_s)..time.partition_point(|t| *t <= to_s);
        let time_s = if self.resample {
            if to_s < from_s { Vec::new() } else { grid(from_s, to_s, self.rate_hz) }
        } else {
            time.get(own.clone()).map(<[f64]>::to_vec).unwrap_or_default()
        };
        let cut = |series: &[f64]| series.get(own.clone()).map(<[f64]>::to_vec).unwrap_or_default();
        let positions = recording.position_rad.iter().map(|q| {
            let q = &q[run.clone()];
            if self.resample { smooth(time, q, &time_s) } else { cut(q) }
        });
        let position_rad = positions.collect();
        let velocity_rad_s = recording.velocity_rad_s.as_ref().map(|family| {
            let at_grid = |v: &Vec<f64>| {
                let v = &v[run.clone()];
                if self.resample { linear(time, v, time_s.iter().copied()) } else { cut(v) }
            };
            family.iter().map(at_grid).collect()
        });
        let measurement = recording.measurement.as_ref().map(|family| {
            let corrected = family.iter().enumerate().map(|(joint, raw)| {
                let y = self.options.corrected(joint, &raw[run.clone()]);
                let delay = delays.get(joint).copied().unwrap_or(0.0);
                if self.resample || delayed {
                    linear(time, &y, time_s.iter().map(|t| t + delay))
                } else {
                    cut(&y)
                }
            });
            corrected.collect()
        });
        OnGrid { time_s, position_rad, velocity_rad_s, measurement }
    }
}
