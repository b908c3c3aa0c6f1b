use std::fmt;
use std::ops::Range;

use aurt_traits::Motion;

use crate::preprocess::differentiate::{inner_acceleration, velocity};
use crate::preprocess::resample::{grid, linear, smooth};
use crate::preprocess::{PreprocessOptions, ZeroPhase, decimate};
use crate::{Recording, RecordingError};

/// A stretch of a recording without gaps, ready for a regressor.
#[derive(Debug, Clone, PartialEq)]
pub struct Segment {
    /// The filtered motion on the uniform grid, one sample lost at either end, rest cut if that was asked for.
    pub motion: Motion,
    /// The measurement after the parallel filter and decimation, `[joint][row]`; row k belongs to motion sample
    /// k · `decimation`. After trimming, the last rows of a regressor decimated from the motion's first sample on
    /// can lie beyond it: the number of rows in use is the smaller one.
    pub measurement: Option<Vec<Vec<f64>>>,
    /// The measurement on the motion's grid, unfiltered, `[joint][sample]`.
    pub raw_measurement: Option<Vec<Vec<f64>>>,
    /// Rate of the grid, in Hz.
    pub rate_hz: f64,
    /// Every how many samples a row is kept.
    pub decimation: usize,
    /// The filter that the measurement passed, to be applied to the regressor's columns over this motion.
    pub parallel_filter: ZeroPhase,
}

impl Segment {
    /// Rows per joint after decimation.
    #[must_use]
    pub fn rows(&self) -> usize {
        let of_motion = self.motion.samples().div_ceil(self.decimation);
        let of_measurement = self.measurement.as_ref().and_then(|m| m.first()).map_or(of_motion, Vec::len);
        of_motion.min(of_measurement)
    }
}

/// Why a stretch between gaps cannot be used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Refusal {
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
                remedy: "record longer, or check max_gap_s and the window".into(),
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
pub(super) struct Plan<'a> {
    pub(super) options: &'a PreprocessOptions,
    pub(super) rate_hz: f64,
    pub(super) resample: bool,
    pub(super) decimation: usize,
    pub(super) position_filter: ZeroPhase,
    pub(super) parallel_filter: ZeroPhase,
}

/// A run of samples on the grid, before filtering.
struct OnGrid {
    time_s: Vec<f64>,
    position_rad: Vec<Vec<f64>>,
    velocity_rad_s: Option<Vec<Vec<f64>>>,
    measurement: Option<Vec<Vec<f64>>>,
}

impl Plan<'_> {
    /// The segment made from the samples `run`, and the rest in s that was cut before and after it.
    pub(super) fn segment(
        &self,
        recording: &Recording,
        run: Range<usize>,
        agreement: &mut VelocityAgreement,
    ) -> Result<Result<(Segment, [f64; 2]), Refusal>, RecordingError> {
        let padding = self.position_filter.padding().max(self.parallel_filter.padding());
        let data = self.on_grid(recording, run);
        let n = data.time_s.len();
        // One sample is lost at either end, and the regressor has to fit the parallel filter.
        let needed = padding + 3;
        if n < needed {
            return Ok(Err(Refusal::Short { samples: n, needed, after: "" }));
        }
        let period_s = 1.0 / self.rate_hz;
        let filtered = self.position_filter.filter_all(&data.position_rad)?;
        let velocities: Vec<Vec<f64>> = filtered.iter().map(|q| velocity(q, period_s)).collect();
        // From here on, indices count the n − 2 samples that have an acceleration.
        let inner = n - 2;
        let kept = match self.kept(&velocities, inner) {
            Ok(kept) => kept,
            Err(refusal) => return Ok(Err(refusal)),
        };
        if kept.len() <= padding {
            let after = " after cutting the rest";
            return Ok(Err(Refusal::Short { samples: kept.len(), needed: padding + 1, after }));
        }
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
        let cut_s = [kept.start as f64 * period_s, (inner - kept.end) as f64 * period_s];
        let motion = Motion::new(filtered.len(), time_s, position, speed, acceleration).map_err(|_| {
            RecordingError::Count {
                what: "values of the motion".into(),
                expected: filtered.len() * kept.len(),
                found: 0,
            }
        })?;

        // After trimming, the measurement loses one more sample at either end, as in the original tool, whose
        // first sample is again that of the motion.
        let measured =
            if self.options.trim_rest { on_motion.start..on_motion.end - 2 } else { on_motion.clone() };
        let measurement = match &data.measurement {
            Some(series) => Some(
                self.parallel_filter
                    .filter_all(series)?
                    .iter()
                    .map(|s| decimate::thin(&s[measured.clone()], self.decimation))
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
        };
        Ok(Ok((segment, cut_s)))
    }

    /// Which of the `inner` samples remain: all, or from the first that moves (at least 1) to before the last.
    fn kept(&self, velocities: &[Vec<f64>], inner: usize) -> Result<Range<usize>, Refusal> {
        if !self.options.trim_rest {
            return Ok(0..inner);
        }
        let threshold = self.options.rest_velocity_rad_s;
        let moves = |k: usize| velocities.iter().any(|v| v[k + 1].abs() > threshold);
        let first = (0..inner).find(|k| moves(*k));
        let last = (0..inner).rev().find(|k| moves(*k));
        if let (Some(first), Some(last)) = (first, last) {
            return Ok(first.max(1)..last.max(1));
        }
        let fastest = velocities
            .iter()
            .map(|v| v[1..=inner].iter().fold(0.0_f64, |m, x| m.max(x.abs())))
            .enumerate()
            .max_by(|a, b| a.1.total_cmp(&b.1));
        let (joint, fastest_rad_s) = fastest.unwrap_or((0, 0.0));
        Err(Refusal::AtRest { joint, fastest_rad_s })
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
                let gain = self.options.gains.as_ref().map_or(1.0, |g| g[joint]);
                let offset = self.options.offsets.as_ref().map_or(0.0, |o| o[joint]);
                let y: Vec<f64> = raw[run.clone()].iter().map(|v| (v - offset) * gain).collect();
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
