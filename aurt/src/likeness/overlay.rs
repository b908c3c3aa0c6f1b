//! Two measurements laid over each other: whether their rows are the same but for digits, and how much of their noise differs.

use std::ops::Range;

use aurt_recording::median;

/// Rows of the coarser recording over which both are compared.
const COMPARED_ROWS: usize = 80;
/// Measurements that differ by more than this many times their noise are not those of one motion.
const OF_NOISE: f64 = 3.0;

/// Two series of which the stamps are those of one clock up to some steps of the coarser.
pub(crate) struct Overlay<'s> {
    /// Stamps and measurement, `[joint][sample]`, of the one with fewer rows.
    pub coarse: (&'s [f64], &'s [&'s [f64]]),
    /// Those of the other.
    pub fine: (&'s [f64], &'s [&'s [f64]]),
    /// Step of the coarser, s.
    pub step_s: f64,
}

impl Overlay<'_> {
    /// The stamps of the coarser that are compared: those that the finer surrounds, whatever they are moved by.
    fn compared(&self) -> Range<usize> {
        let (time_s, fine_s) = (self.coarse.0, self.fine.0);
        let margin_s = 2.0 * self.step_s;
        let begin = time_s.partition_point(|t| *t < fine_s[0] + margin_s);
        let end = time_s.partition_point(|t| *t <= fine_s[fine_s.len() - 1] - margin_s).max(begin);
        let spare = (end - begin).saturating_sub(COMPARED_ROWS) / 2;
        begin + spare..end - spare
    }

    /// By how much stamps of the coarser may have to be moved, s, to lie on rows of the finer.
    fn onto_rows(&self, rows: &Range<usize>) -> Vec<f64> {
        let own_s = self.coarse.0[rows.start.midpoint(rows.end)];
        let near = self.fine.0.iter().map(|t| t - own_s).filter(|shift_s| shift_s.abs() <= 2.0 * self.step_s);
        near.collect()
    }

    /// Whether rows of the coarser are rows of the finer, but for digits.
    pub fn coincides(&self) -> bool {
        let rows = self.compared();
        if rows.len() < 8 {
            return false;
        }
        let bounds: Vec<f64> = self
            .coarse
            .1
            .iter()
            .zip(self.fine.1)
            .map(|(coarse, fine)| {
                0.5 * digit(&coarse[rows.clone()]).max(digit(&fine[..fine.len().min(COMPARED_ROWS)]))
            })
            .collect();
        let varies = |row: &usize| {
            self.coarse.1.iter().zip(&bounds).any(|(y, bound)| (y[*row] - y[*row - 1]).abs() > *bound)
        };
        if (rows.start + 1..rows.end).filter(varies).count() < 12.min(rows.len() / 2) {
            return false;
        }
        self.onto_rows(&rows).into_iter().any(|shift_s| {
            let mut cursor = Cursor::at(self.fine.0, self.coarse.0[rows.start] + shift_s);
            rows.clone().all(|row| {
                let (before, part) = cursor.place(self.coarse.0[row] + shift_s);
                let nearest = if part < 0.5 { before } else { before + 1 };
                self.coarse.1.iter().zip(self.fine.1).zip(&bounds).all(|((coarse, fine), bound)| {
                    (coarse[row] - fine[nearest]).abs() <= bound * (1.0 + 1e-6) + 1e-9 * coarse[row].abs()
                })
            })
        })
    }

    /// The difference of both noises, relative to that of independent ones; the middle one of the joints. None where the
    /// measurements differ by more than noise: the same noise on another motion or robot is that of a simulation.
    pub fn noise(&self) -> Option<f64> {
        let rows = self.compared();
        if rows.len() < 12 {
            return None;
        }
        let pairs = self.coarse.1.iter().zip(self.fine.1);
        let joints: Vec<Compared<'_>> = pairs
            .filter_map(|(coarse, fine)| {
                let coarse = &coarse[rows.clone()];
                let noise = white_noise(coarse);
                (noise > 0.0 && !is_stepped(coarse) && !is_stepped(fine)).then_some((coarse, *fine, noise))
            })
            .collect();
        // Copies are made along lines, or along curves.
        let found = [linear, cubic].map(|between| self.best(&rows, &joints, between));
        let best = found.into_iter().min_by(|a, b| a.noise.total_cmp(&b.noise))?;
        (best.values < OF_NOISE).then_some(best.noise)
    }

    /// The differences where the coarser, moved in time, fits best.
    fn best(&self, rows: &Range<usize>, joints: &[Compared<'_>], between: Between) -> Differences {
        let mut best = (Differences { noise: f64::INFINITY, values: f64::INFINITY }, 0.0);
        let mut stride_s = 0.25 * self.step_s;
        for (first, last) in [(-8, 8), (-1, 1), (-1, 1)] {
            let around_s = best.1;
            for k in first..=last {
                let shift_s = around_s + f64::from(k) * stride_s;
                let differs = self.differences(rows, joints, shift_s, between);
                if differs.noise < best.0.noise {
                    best = (differs, shift_s);
                }
            }
            stride_s *= 0.5;
        }
        best.0
    }

    /// The differences with the coarser moved by so much.
    fn differences(
        &self,
        rows: &Range<usize>,
        joints: &[Compared<'_>],
        shift_s: f64,
        between: Between,
    ) -> Differences {
        let mut cursor = Cursor::at(self.fine.0, self.coarse.0[rows.start] + shift_s);
        let places: Vec<(usize, f64)> =
            rows.clone().map(|row| cursor.place(self.coarse.0[row] + shift_s)).collect();
        let (mut noises, mut values) = (Vec::new(), 0.0_f64);
        for (coarse, fine, own) in joints {
            let fine: Vec<f64> = places.iter().map(|at| between(fine, *at)).collect();
            let scale = own.hypot(white_noise(&fine));
            let difference: Vec<f64> = coarse.iter().zip(&fine).map(|(a, b)| a - b).collect();
            noises.push(middle_size(&difference, &FOURTH) / scale);
            values = values.max(middle_size(&difference, &[1.0]) / scale);
        }
        Differences { noise: if noises.is_empty() { f64::INFINITY } else { median(&mut noises) }, values }
    }
}

/// Rows of the coarser, the finer, and the noise of these rows.
type Compared<'s> = (&'s [f64], &'s [f64], f64);
/// The value of a series at a place between rows.
type Between = fn(&[f64], (usize, f64)) -> f64;

/// Differences of two measurements, relative to the noise of both.
struct Differences {
    /// Of the noise, the middle one of the joints.
    noise: f64,
    /// Of the values themselves, the largest of the joints.
    values: f64,
}

/// Binomial coefficients with the sum of squares 1: of white noise the size stays.
const FOURTH: [f64; 5] = [0.119_523, -0.478_091, 0.717_137, -0.478_091, 0.119_523];
const SIXTH: [f64; 7] = [0.032_898, -0.197_386, 0.493_464, -0.657_952, 0.493_464, -0.197_386, 0.032_898];

/// The size of white noise that is in a series: a motion is less in sixth differences than in fourth.
fn white_noise(y: &[f64]) -> f64 {
    middle_size(y, &FOURTH).min(middle_size(y, &SIXTH))
}

fn middle_size(y: &[f64], weights: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = y
        .windows(weights.len())
        .map(|w| w.iter().zip(weights).map(|(v, w)| v * w).sum::<f64>().abs())
        .collect();
    if sizes.is_empty() { 0.0 } else { median(&mut sizes) }
}

/// Whether values are so coarse that their differences repeat.
fn is_stepped(y: &[f64]) -> bool {
    let mut all: Vec<f64> = y
        .windows(5)
        .map(|w| 1e-9 * (1e9 * (w[0] - 4.0 * w[1] + 6.0 * w[2] - 4.0 * w[3] + w[4])).round())
        .collect();
    let rows = all.len();
    all.sort_by(f64::total_cmp);
    all.dedup();
    4 * all.len() < rows
}

/// The power of ten of which all values are multiples; 0 without one.
fn digit(values: &[f64]) -> f64 {
    let steps = (-2..9).map(|digits| 10.0_f64.powi(-digits));
    let is_step = |step: &f64| {
        values.iter().all(|v| (v / step - (v / step).round()).abs() < 1e-6 * (v / step).abs().max(1e-3))
    };
    steps.into_iter().find(is_step).unwrap_or(0.0)
}

/// A place between rows: the row before and the part of the step to the next.
pub(crate) struct Cursor<'s> {
    time_s: &'s [f64],
    before: usize,
}

impl<'s> Cursor<'s> {
    pub fn at(time_s: &'s [f64], t: f64) -> Self {
        Self { time_s, before: time_s.partition_point(|other| *other <= t).saturating_sub(1) }
    }

    pub fn place(&mut self, t: f64) -> (usize, f64) {
        let last = self.time_s.len() - 2;
        while self.before < last && self.time_s[self.before + 1] <= t {
            self.before += 1;
        }
        let before = self.before.min(last);
        let (from, to) = (self.time_s[before], self.time_s[before + 1]);
        (before, ((t - from) / (to - from)).clamp(0.0, 1.0))
    }
}

pub(crate) fn linear(y: &[f64], (before, part): (usize, f64)) -> f64 {
    y[before] + part * (y[before + 1] - y[before])
}

/// By the cubic through the four rows around; the line at the ends.
fn cubic(y: &[f64], (before, p): (usize, f64)) -> f64 {
    if before == 0 || before + 2 >= y.len() {
        return linear(y, (before, p));
    }
    let [a, b, c, d] = [y[before - 1], y[before], y[before + 1], y[before + 2]];
    let (slope_b, slope_c) = (0.5 * (c - a), 0.5 * (d - b));
    let rise = c - b;
    b + p * (slope_b + p * ((3.0 * rise - 2.0 * slope_b - slope_c) + p * (slope_b + slope_c - 2.0 * rise)))
}
