//! Copies that differ from their recording: every so many rows of it, fewer digits, values between its rows.
//!
//! A programme that runs twice repeats its motion, but not the noise of the measurement. Pieces of one recording are laid over
//! the other where the motion is the same, and moved in time until both measurements agree best. Rows of a thinned or rounded
//! copy agree to the last digit. The noise of two repetitions is independent, so that their difference has as much noise as
//! both together; in a resampled copy it has a fraction.

mod overlay;

use std::fmt;
use std::ops::Range;

use aurt_recording::median_step_s;
use overlay::{Cursor, Overlay, linear};

const FEWEST_ROWS: usize = 16;
const PIECE_ROWS: usize = 128;
/// Fewest pieces of a recording that are kept, if it has as many.
const PIECES: usize = 24;
const MOST_PIECES: usize = 256;
/// Time between pieces of a long recording, s.
const APART_S: f64 = 10.0;
/// Places with the same motion that are looked at for a piece.
const PLACES: usize = 3;
/// Difference of two positions, relative to the motion of the piece, up to which both are the same motion.
const SAME_MOTION: f64 = 0.1;
/// Difference of two noises, relative to that of independent ones, below which they are the same noise.
const SAME_NOISE: f64 = 0.45;
/// Pieces with the same noise that make a copy.
const ENOUGH: usize = 3;
/// Pieces of the same motion and other noise that make a repetition.
const REPEATED: usize = 5;

/// Series of a recording at its stamps.
#[derive(Debug, Clone, Copy)]
pub struct Series<'r> {
    /// Stamps, s.
    pub time_s: &'r [f64],
    /// The motion, `[joint][sample]`.
    pub motion: &'r [Vec<f64>],
    /// What was measured, `[joint][sample]`.
    pub measured: &'r [Vec<f64>],
}

/// The way in which a recording is the copy of another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Likeness {
    /// The same samples.
    Same,
    /// Every so many rows of the other.
    Thinned(usize),
    /// Every so many rows of it are the other.
    Filled(usize),
    /// The same rows with other digits.
    Rounded,
    /// Values between the rows of the other.
    Resampled,
}

impl fmt::Display for Likeness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Same => f.write_str("holds the same samples as"),
            Self::Thinned(every) => write!(f, "holds every {} row of", Ordinal(*every)),
            Self::Filled(every) => write!(f, "holds, as every {} row, the samples of", Ordinal(*every)),
            Self::Rounded => f.write_str("holds, with other digits, the same samples as"),
            Self::Resampled => f.write_str("holds, at other times, the same motion and the same noise as"),
        }
    }
}

/// A number as the place in a row.
struct Ordinal(usize);

impl fmt::Display for Ordinal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ending = match (self.0 % 10, self.0 % 100) {
            (_, 11..=13) => "th",
            (1, _) => "st",
            (2, _) => "nd",
            (3, _) => "rd",
            _ => "th",
        };
        write!(f, "{}{ending}", self.0)
    }
}

/// Pieces of a recording by which its copies are known.
#[derive(Debug, Default)]
pub struct Pieces {
    pieces: Vec<Piece>,
    step_s: f64,
}

#[derive(Debug)]
struct Piece {
    time_s: Vec<f64>,
    motion: Vec<Vec<f64>>,
    measured: Vec<Vec<f64>>,
    /// The joint that is fastest, and where.
    joint: usize,
    row: usize,
    /// Of each joint from end to end of its range, squared and summed.
    extent: f64,
}

impl Pieces {
    /// Those of some rows.
    pub fn of(series: &Series<'_>, rows: Range<usize>) -> Self {
        let rows = rows.start..rows.end.min(series.time_s.len());
        let length = PIECE_ROWS.min(rows.len());
        if length < FEWEST_ROWS || series.measured.is_empty() {
            return Self::default();
        }
        let duration_s = series.time_s[rows.end - 1] - series.time_s[rows.start];
        let wanted = ((duration_s / APART_S) as usize).clamp(PIECES, MOST_PIECES).min(rows.len() / length);
        let between = rows.len() / wanted;
        let pieces = (0..wanted).filter_map(|k| {
            let begin = rows.start + k * between;
            Piece::of(series, begin..begin + length)
        });
        Self { pieces: pieces.collect(), step_s: median_step_s(&series.time_s[rows.clone()]).unwrap_or(0.0) }
    }

    /// The way in which some rows of a recording are a copy of these, if they are.
    pub fn likeness(&self, series: &Series<'_>, rows: Range<usize>) -> Option<Likeness> {
        let rows = rows.start..rows.end.min(series.time_s.len());
        if rows.len() < FEWEST_ROWS {
            return None;
        }
        let used =
            Counterpart { series, step_s: median_step_s(&series.time_s[rows.clone()]).unwrap_or(0.0), rows };
        let (mut same, mut other, mut found) = (0, 0, None);
        for piece in spread(&self.pieces) {
            let places = piece.places(&used);
            if places.is_empty() {
                continue;
            }
            let likeness = places.iter().find_map(|shift_s| piece.likeness(self.step_s, &used, *shift_s));
            if likeness.is_some() {
                same += 1;
                // Of a thinned copy pieces with few changes agree between rows, too.
                found = found.filter(|known| *known != Likeness::Resampled).or(likeness);
            } else {
                other += 1;
            }
            if (same == 0 && other >= REPEATED) || (same >= 2 * ENOUGH && same > 2 * other) {
                break;
            }
        }
        found.filter(|_| same >= ENOUGH.min(self.pieces.len()) && same > other)
    }
}

/// Rows of a recording that are compared with pieces of another.
struct Counterpart<'s> {
    series: &'s Series<'s>,
    rows: Range<usize>,
    step_s: f64,
}

/// All in an order that is everywhere soon.
fn spread<T>(all: &[T]) -> impl Iterator<Item = &T> {
    let n = all.len();
    let stride = (1..).map(|k| (n * 618) / 1000 + k).find(|s| gcd(*s, n.max(1)) == 1).unwrap_or(1);
    (0..n).map(move |k| &all[(k * stride) % n])
}

const fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

impl Piece {
    /// None where nothing moves.
    fn of(series: &Series<'_>, rows: Range<usize>) -> Option<Self> {
        let cut = |all: &[Vec<f64>]| all.iter().map(|one| one[rows.clone()].to_vec()).collect::<Vec<_>>();
        let motion = cut(series.motion);
        let inner = rows.len() / 4..rows.len() - rows.len() / 4 - 1;
        let steps = motion
            .iter()
            .enumerate()
            .flat_map(|(joint, q)| inner.clone().map(move |row| (joint, row, (q[row + 1] - q[row]).abs())));
        let (joint, row, speed) = steps.max_by(|a, b| a.2.total_cmp(&b.2))?;
        let extent = motion.iter().map(|q| {
            let low = q.iter().copied().fold(f64::INFINITY, f64::min);
            (q.iter().copied().fold(f64::NEG_INFINITY, f64::max) - low).powi(2)
        });
        let extent = extent.sum();
        (speed > 0.0).then(|| Self {
            time_s: series.time_s[rows.clone()].to_vec(),
            measured: cut(series.measured),
            motion,
            joint,
            row,
            extent,
        })
    }

    /// By how much stamps have to be moved to lie where a recording has this motion; the most alike first.
    fn places(&self, used: &Counterpart<'_>) -> Vec<f64> {
        let Counterpart { series, rows, .. } = used;
        let own = &self.motion[self.joint][self.row..self.row + 2];
        let level = 0.5 * (own[0] + own[1]);
        let rises = own[1] > own[0];
        let own_s = 0.5 * (self.time_s[self.row] + self.time_s[self.row + 1]);
        let q = &series.motion[self.joint][rows.clone()];
        let time_s = &series.time_s[rows.clone()];
        let ends_s = [self.time_s[0], self.time_s[self.time_s.len() - 1]];
        let mut places: Vec<(f64, f64)> = Vec::new();
        for (k, pair) in q.windows(2).enumerate() {
            let [a, b] = [pair[0], pair[1]];
            if (b > a) != rises || a == b || (a - level) * (b - level) > 0.0 {
                continue;
            }
            let at_s = time_s[k] + (time_s[k + 1] - time_s[k]) * (level - a) / (b - a);
            let shift_s = at_s - own_s;
            if ends_s[0] + shift_s < time_s[0] || ends_s[1] + shift_s > time_s[time_s.len() - 1] {
                continue;
            }
            let differences = [0, self.row, self.time_s.len() - 1].map(|row| {
                let t = self.time_s[row] + shift_s;
                let place = Cursor::at(time_s, t).place(t);
                let joints = series.motion.iter().zip(&self.motion);
                joints.map(|(q, own)| (linear(&q[rows.clone()], place) - own[row]).powi(2)).sum::<f64>()
            });
            let differs = differences.into_iter().fold(0.0, f64::max);
            if differs < SAME_MOTION.powi(2) * self.extent {
                places.push((differs, shift_s));
            }
        }
        places.sort_by(|a, b| a.0.total_cmp(&b.0));
        places.truncate(PLACES);
        places.into_iter().map(|(_, shift_s)| shift_s).collect()
    }

    /// The way in which the measurement near a place is this one.
    fn likeness(&self, own_step_s: f64, used: &Counterpart<'_>, shift_s: f64) -> Option<Likeness> {
        let Counterpart { series, rows, step_s } = used;
        let (long_s, short_s) = (step_s.max(own_step_s), step_s.min(own_step_s));
        let time_s = &series.time_s[rows.clone()];
        let [first_s, last_s] = [self.time_s[0], self.time_s[self.time_s.len() - 1]].map(|t| t + shift_s);
        let begin = rows.start + time_s.partition_point(|t| *t < first_s - 3.0 * long_s);
        let near = begin..rows.start + time_s.partition_point(|t| *t <= last_s + 3.0 * long_s);
        if near.len() < FEWEST_ROWS / 2 {
            return None;
        }
        let theirs: Vec<&[f64]> = series.measured.iter().map(|one| &one[near.clone()]).collect();
        let their_time_s: Vec<f64> = series.time_s[near].iter().map(|t| t - shift_s).collect();
        let ours: Vec<&[f64]> = self.measured.iter().map(Vec::as_slice).collect();
        let (ours, theirs) = ((&self.time_s[..], &ours[..]), (&their_time_s[..], &theirs[..]));
        let is_coarser = *step_s > 0.99 * own_step_s;
        let (coarse, fine) = if is_coarser { (theirs, ours) } else { (ours, theirs) };
        let overlay = Overlay { coarse, fine, step_s: long_s };
        if overlay.coincides() {
            return Some(match ((long_s / short_s).round() as usize, is_coarser) {
                (0 | 1, _) => Likeness::Rounded,
                (every, true) => Likeness::Thinned(every),
                (every, false) => Likeness::Filled(every),
            });
        }
        // Of two of about one step either may be the copy, whose values are those between rows of the other.
        let swapped =
            (long_s < 1.5 * short_s).then_some(Overlay { coarse: fine, fine: coarse, step_s: long_s });
        let is_same = |overlay: Overlay<'_>| overlay.noise().is_some_and(|noise| noise < SAME_NOISE);
        (is_same(overlay) || swapped.is_some_and(is_same)).then_some(Likeness::Resampled)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stamps, positions and torques of two joints.
    type Recorded = (Vec<f64>, Vec<Vec<f64>>, Vec<Vec<f64>>);

    /// A programme of 30 s, run once more with another seed: of its torques noise is a hundredth.
    fn run(rate_hz: f64, begin_s: f64, seed: u64) -> Recorded {
        let time_s: Vec<f64> = (0..(30.0 * rate_hz) as usize).map(|k| begin_s + k as f64 / rate_hz).collect();
        let of = |f: &dyn Fn(f64) -> f64| time_s.iter().map(|t| f(*t)).collect::<Vec<_>>();
        let motion = vec![
            of(&|t| (0.7 * t).sin() + 0.3 * (1.9 * t).cos()),
            of(&|t| 0.8 * (0.45 * t).cos() - 0.2 * (2.3 * t).sin()),
        ];
        let mut state = seed;
        let mut noise = || {
            let drawn = (0..12).map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (state >> 11) as f64 / (1_u64 << 53) as f64
            });
            drawn.sum::<f64>() - 6.0
        };
        let size = if seed == 0 { 0.0 } else { 0.1 };
        let clean =
            [of(&|t| 9.0 * (0.7 * t).sin() + (1.9 * t).cos().signum()), of(&|t| 5.0 * (0.45 * t).cos())];
        let measured = clean.map(|torque| torque.into_iter().map(|y| y + size * noise()).collect()).into();
        (time_s, motion, measured)
    }

    fn series((time_s, motion, measured): &Recorded) -> Series<'_> {
        Series { time_s, motion, measured }
    }

    fn likeness(first: &Recorded, second: &Recorded) -> Option<Likeness> {
        Pieces::of(&series(first), 0..first.0.len()).likeness(&series(second), 0..second.0.len())
    }

    fn thinned((time_s, motion, measured): &Recorded, every: usize) -> Recorded {
        let thin =
            |all: &[Vec<f64>]| all.iter().map(|y| y.iter().copied().step_by(every).collect()).collect();
        (time_s.iter().copied().step_by(every).map(|t| t + 41.3).collect(), thin(motion), thin(measured))
    }

    fn rounded((time_s, motion, measured): &Recorded, digits: i32) -> Recorded {
        let step = 10.0_f64.powi(-digits);
        let round = |all: &[Vec<f64>]| {
            all.iter().map(|y| y.iter().map(|v| (v / step).round() * step).collect()).collect()
        };
        (time_s.clone(), motion.clone(), round(measured))
    }

    /// Values on lines between rows.
    fn resampled((time_s, motion, measured): &Recorded, rate_hz: f64) -> Recorded {
        let count = ((time_s[time_s.len() - 1] - time_s[0]) * rate_hz) as usize;
        let at: Vec<f64> = (1..count).map(|k| time_s[0] + 0.003 + k as f64 / rate_hz).collect();
        let at: Vec<f64> = at.into_iter().filter(|t| *t < time_s[time_s.len() - 1]).collect();
        let lines = |all: &[Vec<f64>]| {
            let line =
                |y: &Vec<f64>| at.iter().map(|t| linear(y, Cursor::at(time_s, *t).place(*t))).collect();
            all.iter().map(line).collect()
        };
        (at.iter().map(|t| t - 7.0).collect(), lines(motion), lines(measured))
    }

    #[test]
    fn thinned_copies_are_known_whichever_comes_first() {
        let recording = run(100.0, 0.0, 1);
        for every in [2, 3, 5] {
            let copy = thinned(&recording, every);
            assert_eq!(likeness(&recording, &copy), Some(Likeness::Thinned(every)));
            assert_eq!(likeness(&copy, &recording), Some(Likeness::Filled(every)));
        }
    }

    #[test]
    fn rounded_copies_are_known_even_where_digits_are_coarser_than_the_noise() {
        let recording = run(100.0, 0.0, 1);
        for digits in [0, 1, 3] {
            assert_eq!(
                likeness(&recording, &rounded(&recording, digits)),
                Some(Likeness::Rounded),
                "{digits}"
            );
        }
        let both = rounded(&thinned(&recording, 2), 1);
        assert_eq!(likeness(&recording, &both), Some(Likeness::Thinned(2)));
    }

    #[test]
    fn copies_between_rows_are_known() {
        let recording = run(100.0, 0.0, 1);
        for rate_hz in [37.0, 83.0, 100.0, 230.0] {
            let copy = resampled(&recording, rate_hz);
            assert_eq!(likeness(&recording, &copy), Some(Likeness::Resampled), "{rate_hz} Hz");
            assert_eq!(likeness(&copy, &recording), Some(Likeness::Resampled), "{rate_hz} Hz");
        }
    }

    #[test]
    fn a_programme_that_runs_again_is_another_recording() {
        let first = run(100.0, 0.0, 1);
        for again in
            [run(100.0, 0.0, 2), run(100.0, 0.004, 3), run(40.0, 0.0, 4), rounded(&run(100.0, 0.0, 5), 1)]
        {
            assert_eq!(likeness(&first, &again), None);
            assert_eq!(likeness(&again, &first), None);
        }
    }

    /// Simulations of one seed have one noise, whatever changes between them.
    #[test]
    fn another_load_under_the_same_noise_is_another_recording() {
        let first = run(100.0, 0.0, 1);
        let mut loaded = run(100.0, 0.0, 1);
        let weight = loaded.1[1].iter().map(|q| 0.8 * q.cos()).collect::<Vec<_>>();
        loaded.2[1].iter_mut().zip(weight).for_each(|(torque, weight)| *torque += weight);
        assert_eq!(likeness(&first, &loaded), None);
    }

    /// Without noise all that two runs differ in is what changed between them.
    #[test]
    fn noise_free_runs_differ_by_a_change_of_the_robot() {
        let first = run(100.0, 0.0, 0);
        let mut changed = first.clone();
        changed.2[0].iter_mut().for_each(|y| *y *= 1.02);
        changed.2[1].iter_mut().for_each(|y| *y *= 1.03);
        assert_eq!(likeness(&first, &changed), None);
        assert_eq!(likeness(&first, &thinned(&first, 2)), Some(Likeness::Thinned(2)));
    }
}
