use std::ops::Range;

use aurt_traits::Motion;

use crate::error::RecordingError;
use crate::long::recording::LongRecording;
use crate::long::uniform::Uniform;
use crate::preprocess::segment::Plan;
use crate::preprocess::span::{inner_acceleration, velocity};
use crate::preprocess::{
    DroppedSegment, PreprocessOptions, PreprocessReport, SegmentReport, ZeroPhase, ZeroPhaseBank,
    shortest_between_gaps,
};

/// Motion samples of a stretch; memory is a few times their size.
const STRETCH: usize = 1 << 15;

/// What a stretch does not see beyond its ends would change its samples by no more than this share of their size.
const NEGLIGIBLE: f64 = 1e-17;

/// A long recording made ready for calibration, as [`preprocess`](crate::preprocess()) does it.
///
/// Stretches overlap by as many samples as the filters need to forget their start to 1e-17, so that the result is that
/// of the whole recording to rounding (tested: 1e-12 of a series' size).
#[derive(Debug)]
pub struct LongPrepared {
    recording: LongRecording,
    plan: Plan,
    segments: Vec<LongSegment>,
    report: PreprocessReport,
}

/// A run of samples without gaps.
#[derive(Debug, Clone)]
pub struct LongSegment {
    /// Samples of the recording.
    run: Range<usize>,
    /// Motion sample k is sample `run.start` + `first` + k.
    first: usize,
    samples: usize,
    kept_rows: Range<usize>,
    decimation: usize,
}

/// Consecutive samples of a segment.
#[derive(Debug, Clone)]
pub struct Stretch {
    /// The filtered motion.
    pub motion: Motion,
    /// Index of its first sample within the segment.
    pub first_sample: usize,
    /// The filtered measurement at every decimation-th sample of the segment, `[joint][row]`.
    pub measurement: Vec<Vec<f64>>,
    /// Index of the first of these rows within the segment.
    pub first_row: usize,
}

impl LongSegment {
    /// Number of motion samples.
    pub const fn samples(&self) -> usize {
        self.samples
    }

    /// Rows per joint after decimation.
    pub fn rows(&self) -> usize {
        self.kept_rows.len()
    }

    /// The sample of the motion to which a row belongs.
    pub const fn sample(&self, row: usize) -> usize {
        (self.kept_rows.start + row) * self.decimation
    }
}

impl LongRecording {
    /// Finds the clock, the gaps and the rest at the ends, and makes the filters.
    ///
    /// # Errors
    /// As [`preprocess`](crate::preprocess()); also [`RecordingError::Clock`] for stamps that are not uniform and
    /// [`RecordingError::InvalidOption`] for delays: both need samples between samples, which are made of whole
    /// recordings only.
    pub fn prepare(mut self, options: &PreprocessOptions) -> Result<LongPrepared, RecordingError> {
        options.validate(self.joints)?;
        if let Some(value) = options.delay_s.iter().flatten().copied().find(|d| *d != 0.0) {
            let remedy = "delays need a recording that is read whole";
            return Err(RecordingError::option("delay_s", value, remedy));
        }
        self.spill.finish().map_err(|source| self.failed(source))?;
        let Uniform { rate_hz, runs, spans_s, max_gap_s, report: clock } = Uniform::of(&self, options)?;
        let of = (self.file.as_path(), self.samples(), self.joints);
        let (plan, report) = Plan::new(of, options, (rate_hz, false, max_gap_s), clock)?;
        let mut prepared = LongPrepared { recording: self, plan, segments: Vec::new(), report };
        let shortest = shortest_between_gaps(options, runs.len(), rate_hz);
        let needed = shortest.max(prepared.plan.padding() + 3);
        let mut longest = 0;
        for (run, span_s) in runs.into_iter().zip(spans_s) {
            longest = longest.max(run.len());
            let samples = run.len();
            let segment = if samples >= needed { prepared.segment(run, span_s[0])? } else { None };
            if let Some((segment, reported)) = segment {
                prepared.report.segments.push(reported);
                prepared.segments.push(segment);
            } else {
                let reason = if samples < needed {
                    format!("{samples} samples are too few, {needed} are needed")
                } else {
                    "too little of it is motion beyond the filters' memory of its ends".into()
                };
                let [from_s, to_s] = span_s;
                prepared.report.dropped_segments.push(DroppedSegment { from_s, to_s, reason });
            }
        }
        if prepared.segments.is_empty() {
            return Err(RecordingError::TooShort {
                path: prepared.recording.file.clone(),
                samples: longest,
                needed,
                after: " in motion between gaps",
                remedy: "record longer, or check max_gap_s, trim_rest and rest_velocity_rad_s".into(),
            });
        }
        Ok(prepared)
    }
}

impl LongPrepared {
    /// Number of joints.
    pub const fn joints(&self) -> usize {
        self.recording.joints
    }

    /// What messages call the recording.
    pub fn name(&self) -> String {
        self.recording.file.display().to_string()
    }

    /// Whether something was measured.
    pub const fn is_measured(&self) -> bool {
        self.recording.measured
    }

    /// The recording.
    pub const fn recording(&self) -> &LongRecording {
        &self.recording
    }

    /// What was found and done. The median distance of stamps is that of the first 65 536; measured velocities are not
    /// looked at.
    pub const fn report(&self) -> &PreprocessReport {
        &self.report
    }

    /// Every how many samples a row is kept.
    pub const fn decimation(&self) -> usize {
        self.plan.decimation
    }

    /// The filter that the measurement passed, to be applied to the regressor's columns.
    pub const fn parallel_filter(&self) -> &ZeroPhase {
        &self.plan.parallel_filter
    }

    /// The stretches without gaps, in order of time.
    pub fn segments(&self) -> &[LongSegment] {
        &self.segments
    }

    /// The parallel filter for columns over a segment's motion; it hands out the rows.
    pub fn bank(&self, segment: &LongSegment, columns: usize) -> ZeroPhaseBank {
        let bank = ZeroPhaseBank::new(&self.plan.parallel_filter, columns, self.plan.decimation);
        bank.keeping(segment.kept_rows.clone())
    }

    /// Hands out a segment's samples, in their order.
    ///
    /// # Errors
    /// [`RecordingError::Spill`], and what `visit` returns.
    pub fn for_each_stretch<E: From<RecordingError>>(
        &self,
        segment: &LongSegment,
        mut visit: impl FnMut(&Stretch) -> Result<(), E>,
    ) -> Result<(), E> {
        for first in (0..segment.samples).step_by(STRETCH) {
            let end = (first + STRETCH).min(segment.samples);
            visit(&self.stretch(segment, first..end)?)?;
        }
        Ok(())
    }

    /// Samples after which neither filter remembers its start.
    fn overlap(&self) -> usize {
        let decay = |filter: &ZeroPhase| filter.design().decay_samples(NEGLIGIBLE) + filter.padding();
        decay(&self.plan.position_filter).max(decay(&self.plan.parallel_filter))
    }

    /// The segment of a run that begins at `from_s`; none if nothing moves or too little is left.
    fn segment(
        &self,
        run: Range<usize>,
        from_s: f64,
    ) -> Result<Option<(LongSegment, SegmentReport)>, RecordingError> {
        let inner = run.len() - 2;
        let pieces: Vec<Range<usize>> =
            (0..inner).step_by(STRETCH).map(|a| a..(a + STRETCH).min(inner)).collect();
        let first = self.first_moving(&run, pieces.iter(), |moving| moving.next())?;
        let last = self.first_moving(&run, pieces.iter().rev(), |moving| moving.last())?;
        let moving = first.zip(last).map(|(first, last)| [first, last]);
        if moving.is_none() && self.plan.options.trim_rest {
            return Ok(None);
        }
        let span = self.plan.memory().span(&self.plan.options, inner, moving);
        if span.refused(self.plan.padding()).is_some() {
            return Ok(None);
        }
        let (first, samples) = (span.motion.start + 1, span.motion.len());
        let segment = LongSegment {
            run,
            first,
            samples,
            kept_rows: span.kept_rows(),
            decimation: self.plan.decimation,
        };
        Ok(Some((segment, span.reported(from_s, self.plan.rate_hz))))
    }

    /// Of the first piece with a moving sample the one that is chosen, counted without the run's first sample.
    fn first_moving<'p>(
        &self,
        run: &Range<usize>,
        pieces: impl Iterator<Item = &'p Range<usize>>,
        choose: impl Fn(&mut dyn Iterator<Item = usize>) -> Option<usize>,
    ) -> Result<Option<usize>, RecordingError> {
        let threshold = self.plan.options.rest_velocity_rad_s;
        for piece in pieces {
            let (series, own) = self.window(run, piece.start + 1..piece.end + 1)?;
            let filtered =
                self.plan.options.smoothed(&self.plan.position_filter, &series[1..=self.joints()])?;
            let speeds: Vec<Vec<f64>> =
                filtered.iter().map(|q| velocity(q, 1.0 / self.plan.rate_hz)).collect();
            let mut moving = own.clone().filter(|k| speeds.iter().any(|v| v[*k].abs() > threshold));
            if let Some(k) = choose(&mut moving) {
                return Ok(Some(piece.start + k - own.start));
            }
        }
        Ok(None)
    }

    /// Time, positions and measurements around the samples `wanted` of a run, and where these lie in them.
    fn window(
        &self,
        run: &Range<usize>,
        wanted: Range<usize>,
    ) -> Result<(Vec<Vec<f64>>, Range<usize>), RecordingError> {
        let overlap = self.overlap() + 1;
        let window = wanted.start.saturating_sub(overlap)..(wanted.end + overlap).min(run.len());
        let rows = run.start + window.start..run.start + window.end;
        let series = self.recording.spill.read(rows).map_err(|source| self.recording.failed(source))?;
        Ok((series, wanted.start - window.start..wanted.end - window.start))
    }

    fn stretch(&self, segment: &LongSegment, samples: Range<usize>) -> Result<Stretch, RecordingError> {
        let joints = self.joints();
        let wanted = segment.first + samples.start..segment.first + samples.end;
        let (series, own) = self.window(&segment.run, wanted)?;
        let (time, values) = series.split_at(1);
        let (positions, measurements) = values.split_at(joints);
        let filtered = self.plan.options.smoothed(&self.plan.position_filter, positions)?;
        let period_s = 1.0 / self.plan.rate_hz;
        let mut motion = [Vec::new(), Vec::new(), Vec::new()];
        for q in &filtered {
            motion[0].extend_from_slice(&q[own.clone()]);
            let around = &q[own.start - 1..=own.end];
            motion[1].extend_from_slice(&velocity(around, period_s)[1..=own.len()]);
            motion[2].extend(inner_acceleration(around, period_s));
        }
        let [position, speed, acceleration] = motion;
        let motion = Motion::new(joints, time[0][own.clone()].to_vec(), position, speed, acceleration)
            .map_err(|_| RecordingError::count("values of the motion", joints * own.len(), 0))?;
        let corrected: Vec<Vec<f64>> = measurements
            .iter()
            .enumerate()
            .map(|(joint, raw)| self.plan.options.corrected(joint, raw))
            .collect();
        let before = |sample: usize| {
            sample.div_ceil(self.plan.decimation).saturating_sub(segment.kept_rows.start).min(segment.rows())
        };
        let rows = before(samples.start)..before(samples.end);
        let at = |row: usize| own.start + segment.sample(row) - samples.start;
        let measurement = self
            .plan
            .parallel_filter
            .filter_all(&corrected)?
            .iter()
            .map(|y| rows.clone().map(|row| y[at(row)]).collect())
            .collect();
        Ok(Stretch { motion, first_sample: samples.start, measurement, first_row: rows.start })
    }
}
