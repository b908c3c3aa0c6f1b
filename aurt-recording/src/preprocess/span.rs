use std::ops::Range;

use crate::preprocess::options::PreprocessOptions;
use crate::preprocess::report::{Refusal, SegmentReport};
use crate::preprocess::zero_phase::ZeroPhase;

/// Samples from which filtered series are what they would be if the recording did not end; see [`ZeroPhase::memory`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Memory {
    /// The motion: the position filter, and the sample that differences reach.
    motion: usize,
    /// Regressor and measurement: the parallel filter, in whole rows.
    parallel: usize,
    decimation: usize,
}

/// Which samples of a run a segment has. Samples count among those that have an acceleration, the run's but its first and last.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Span {
    /// Those whose motion it has.
    pub(crate) motion: Range<usize>,
    /// From the first row to the last.
    pub(crate) rows: Range<usize>,
    /// What would be rows if the run did not end.
    wanted: Range<usize>,
    /// Of these, samples within the filters' memory of an end.
    near_ends: usize,
    /// Samples of a run at its ends of which no row counts.
    lost: usize,
    all: usize,
    decimation: usize,
}

impl Memory {
    pub(crate) fn of(position: &ZeroPhase, parallel: &ZeroPhase, decimation: usize) -> Self {
        let parallel = parallel.memory().next_multiple_of(decimation);
        Self { motion: position.memory() + 1, parallel, decimation }
    }

    /// Samples at either end of a run of which no row counts.
    const fn of_rows(&self) -> usize {
        self.motion + self.parallel
    }

    pub(crate) fn of_rows_s(&self, rate_hz: f64) -> f64 {
        self.of_rows() as f64 / rate_hz
    }

    /// The span of a run of `all` samples that moves from the first to the last of `moving`.
    ///
    /// Filters continue a series by its mirror image through the end point: wrong where the robot moves there, and with all of
    /// that one sample's noise where it stands.
    pub(crate) fn span(&self, options: &PreprocessOptions, all: usize, moving: Option<[usize; 2]>) -> Span {
        let (decimation, memory) = (self.decimation, self.of_rows());
        let wanted = match moving.filter(|_| options.trim_rest) {
            Some([first, last]) => first..last + 1,
            None if options.trim_rest => all..all,
            None => 0..all,
        };
        // Rows lie where they would if the run did not begin there, whatever the filters remember.
        let start = wanted.start + memory.saturating_sub(wanted.start).next_multiple_of(decimation);
        let rows = start..wanted.end.min(all.saturating_sub(memory)).max(start);
        let near_ends = wanted.len() - rows.len().min(wanted.len());
        if options.count_ends {
            // After trimming, the measurement loses one more sample at either end, as in the original tool, whose first
            // sample is again that of the motion.
            let (motion, more) = match moving.filter(|_| options.trim_rest) {
                Some([first, last]) => (first.max(1)..last.max(1), 2),
                None => (0..all, 0),
            };
            let rows = motion.start..motion.end.saturating_sub(more).max(motion.start);
            return Span { wanted: motion.clone(), motion, rows, near_ends, lost: 0, all, decimation };
        }
        if options.whole_motion {
            // A run shorter than the filters' memory has a motion and no row.
            let end = rows.end.min(all);
            let rows = rows.start.next_multiple_of(decimation).min(end)..end;
            return Span { motion: 0..all, rows, wanted, near_ends, lost: 0, all, decimation };
        }
        let end = (rows.end + self.parallel).min(all.saturating_sub(self.motion)).max(rows.end);
        Span {
            motion: start - self.parallel..end,
            rows,
            wanted,
            near_ends,
            lost: 2 * memory,
            all,
            decimation,
        }
    }
}

impl Span {
    /// Why there are no rows, if the motion is to be longer than `padding`.
    pub(crate) fn refused(&self, padding: usize) -> Option<Refusal> {
        if self.rows.is_empty() && self.lost > 0 {
            let after = " less those within the filters' memory of ends and gaps";
            return Some(Refusal::Short { samples: self.wanted.len(), needed: self.lost + 1, after });
        }
        let (samples, needed) = (self.motion.len().min(self.wanted.len()), padding + 1);
        let after = if self.wanted.len() < self.all { " after cutting the rest" } else { "" };
        (samples < needed).then_some(Refusal::Short { samples, needed, after })
    }

    /// The rows that count among those from the motion's first sample on.
    pub(crate) fn kept_rows(&self) -> Range<usize> {
        let first = (self.rows.start - self.motion.start) / self.decimation;
        first..first + self.rows.len().div_ceil(self.decimation)
    }

    /// What is told of it; `at_s` is the time of the run's sample before the first, s from the recording's first stamp.
    pub(crate) fn reported(&self, at_s: f64, rate_hz: f64) -> SegmentReport {
        SegmentReport {
            from_s: at_s + (self.rows.start + 1) as f64 / rate_hz,
            to_s: at_s + self.rows.end as f64 / rate_hz,
            samples: self.rows.len(),
            rows: self.kept_rows().len(),
            rows_near_ends: self.near_ends.div_ceil(self.decimation),
            cut_s: [self.wanted.start, self.all - self.wanted.end].map(|samples| samples as f64 / rate_hz),
        }
    }
}

/// Velocities by central differences of uniformly sampled positions, one-sided at both ends
/// (`numpy.gradient`): q̇_k = (q_{k+1} − q_{k−1}) / 2T.
pub(crate) fn velocity(position: &[f64], period_s: f64) -> Vec<f64> {
    let n = position.len();
    if n < 2 {
        return vec![0.0; n];
    }
    let mut out = Vec::with_capacity(n);
    out.push((position[1] - position[0]) / period_s);
    out.extend(position.windows(3).map(|w| (w[2] - w[0]) / (2.0 * period_s)));
    out.push((position[n - 1] - position[n - 2]) / period_s);
    out
}

/// Accelerations at the inner samples by the compact stencil q̈_k = (q_{k+1} − 2q_k + q_{k−1}) / T²,
/// two samples fewer than positions.
pub(crate) fn inner_acceleration(position: &[f64], period_s: f64) -> Vec<f64> {
    let scale = period_s * period_s;
    position.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]) / scale).collect()
}

#[cfg(test)]
mod tests {
    use serde_json::Value;

    use super::*;

    const MEMORY: Memory = Memory { motion: 10, parallel: 30, decimation: 5 };

    fn span(count_ends: bool, trim_rest: bool, moving: [usize; 2]) -> Span {
        let options = PreprocessOptions { count_ends, trim_rest, ..PreprocessOptions::default() };
        MEMORY.span(&options, 1000, Some(moving))
    }

    #[test]
    fn a_run_that_moves_at_its_ends_loses_both_memories() {
        for trim_rest in [true, false] {
            let span = span(false, trim_rest, [0, 999]);
            assert_eq!((span.motion.clone(), span.rows.clone()), (10..990, 40..960));
            assert_eq!(span.kept_rows(), 6..190);
            assert_eq!(span.reported(0.0, 100.0).rows_near_ends, 16);
        }
    }

    #[test]
    fn rest_at_an_end_is_cut_before_what_moves() {
        let long = span(false, true, [100, 800]);
        assert_eq!((long.motion.clone(), long.rows.clone()), (70..831, 100..801));
        assert_eq!(long.reported(0.0, 100.0).rows_near_ends, 0);
        let short = span(false, true, [15, 999]);
        assert_eq!((short.motion.start, short.rows.start), (10, 40));
        assert_eq!(span(false, false, [100, 800]).rows, 40..960);
    }

    #[test]
    fn with_the_ends_all_of_the_motion_counts() {
        let paper = span(true, true, [0, 800]);
        assert_eq!((paper.motion, paper.rows), (1..800, 1..798));
        assert_eq!(span(true, false, [100, 800]).rows, 0..1000);
    }

    /// Values of `numpy.gradient` and of the stencil, made by `tests/reference/make_reference.py`.
    #[test]
    fn equals_numpy() {
        let case: Value =
            serde_json::from_str(include_str!("../../tests/reference/derivatives.json")).unwrap();
        let numbers = |key: &str| {
            case[key].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect::<Vec<f64>>()
        };
        let (position, period_s) = (numbers("position"), case["period_s"].as_f64().unwrap());
        for (own, expected) in [
            (velocity(&position, period_s), numbers("gradient")),
            (inner_acceleration(&position, period_s), numbers("acceleration")),
        ] {
            assert_eq!(own.len(), expected.len());
            let scale = expected.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            assert!(own.iter().zip(&expected).all(|(o, e)| (o - e).abs() < 1e-15 * scale));
        }
    }
}
