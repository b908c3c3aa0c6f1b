//! The same samples in two recordings, as they are or thinned, rounded or resampled: each counts once, and in one role.

use std::collections::{BTreeSet, HashMap};
use std::ops::Range;

use aurt_diagnosis::Role;
use aurt_recording::Recording;

use crate::data::{Loaded, Source};
use crate::error::Error;
use crate::likeness::{Pieces, Series};

pub use crate::likeness::Likeness;

/// Rows in a run by which samples are known again.
const RUN_ROWS: usize = 64;
const RUNS: usize = 32;
/// Recordings, the latest, with which others are compared piece by piece.
const COMPARED: usize = 64;
const BASE: u64 = 0x9e37_79b9_7f4a_7c15;

/// Series with what they are for.
#[derive(Debug, Clone)]
pub struct UsedSeries<'r> {
    /// What the user calls the recording.
    pub label: &'r str,
    /// What it is for: the key that lists it.
    pub role: &'static str,
    /// Stamps, s.
    pub time_s: &'r [f64],
    /// Positions, or commands that drives follow, `[joint][sample]`.
    pub motion: &'r [Vec<f64>],
    /// What was measured of it, with noise that no repetition has, `[joint][sample]`; may be empty.
    pub measured: &'r [Vec<f64>],
    /// The samples that are used.
    pub rows: Range<usize>,
}

impl<'r> UsedSeries<'r> {
    /// The part of a recording that its source asks for.
    pub fn of(source: &'r Source, recording: &'r Recording, role: &'static str) -> Self {
        let time = &recording.time_s;
        let first = time.first().copied().unwrap_or(0.0);
        let rows = source.window_s.map_or(0..time.len(), |[from, to]| {
            let begin = time.partition_point(|t| t - first < from);
            begin..time.partition_point(|t| t - first <= to).max(begin)
        });
        let measured = recording.measurement.as_deref().unwrap_or_default();
        Self { label: &source.label, role, time_s: time, motion: &recording.position_rad, measured, rows }
    }

    fn hashes(&self) -> Vec<u64> {
        let samples = self.motion.first().map_or(0, Vec::len);
        let mut hashes = vec![0_u64; samples];
        for series in self.motion.iter().chain(self.measured) {
            for (hash, value) in hashes.iter_mut().zip(series) {
                *hash = (hash.rotate_left(23) ^ value.to_bits()).wrapping_mul(BASE);
                *hash ^= *hash >> 29;
            }
        }
        hashes
    }

    const fn series(&self) -> Series<'r> {
        Series { time_s: self.time_s, motion: self.motion, measured: self.measured }
    }

    /// Whether a joint is elsewhere than in the row before.
    fn moves(&self, row: usize) -> bool {
        row > 0 && self.motion.iter().any(|q| q[row] != q[row - 1])
    }
}

/// The recordings that were seen, and runs of their rows in which joints move: a robot at rest repeats itself.
#[derive(Debug, Default)]
pub struct SampleRegister {
    seen: Vec<Seen>,
    /// The recording of each run, by its length and hash.
    runs: HashMap<(usize, u64), usize>,
    lengths: BTreeSet<usize>,
}

#[derive(Debug)]
struct Seen {
    label: String,
    role: &'static str,
    whole: u64,
    rows: Range<usize>,
    pieces: Pieces,
}

impl SampleRegister {
    /// Refuses recordings of which one holds samples of another.
    ///
    /// # Errors
    /// [`Error::Repeated`].
    pub fn check<'l>(recordings: impl IntoIterator<Item = (&'l Loaded, &'static str)>) -> Result<(), Error> {
        let mut register = Self::default();
        for (loaded, role) in recordings {
            register.add(&UsedSeries::of(&loaded.source, &loaded.recording, role))?;
        }
        Ok(())
    }

    /// Takes a recording in, unless samples of it are those of one before, whatever the files are called and their clocks say.
    ///
    /// # Errors
    /// [`Error::Repeated`].
    pub fn add(&mut self, used: &UsedSeries<'_>) -> Result<(), Error> {
        let hashes = used.hashes();
        let whole = rolling(&hashes, hashes.len()).next().map_or(0, |(_, hash)| hash);
        // Of one recording windows say what is shared: what it repeats by itself does not matter.
        let same = |seen: &&Seen| seen.whole == whole;
        // Neighbouring windows may share the sample at which one ends and the other begins.
        let overlaps =
            |seen: &&Seen| seen.rows.start + 1 < used.rows.end && used.rows.start + 1 < seen.rows.end;
        let rows = &hashes[used.rows.start.min(hashes.len())..used.rows.end.min(hashes.len())];
        let shared = self.seen.iter().filter(same).find(overlaps).or_else(|| {
            let found = self.lengths.iter().flat_map(|length| {
                rolling(rows, *length).filter_map(|(_, hash)| self.runs.get(&(*length, hash)))
            });
            found.map(|place| &self.seen[*place]).find(|seen| seen.whole != whole)
        });
        // Parts of one recording in files of their own may be judged beside it.
        let by_itself = |seen: &&Seen| seen.role == used.role && used.role == Role::Validation.name();
        let alike = || {
            let others = self.seen.iter().rev().take(COMPARED).filter(|seen| !same(seen) && !by_itself(seen));
            others
                .filter_map(|seen| Some((seen, seen.pieces.likeness(&used.series(), used.rows.clone())?)))
                .next()
        };
        let same_samples =
            shared.filter(|seen| same(seen) || !by_itself(seen)).map(|seen| (seen, Likeness::Same));
        if let Some((seen, likeness)) = same_samples.or_else(alike) {
            return Err(Error::Repeated {
                recording: used.label.into(),
                role: used.role,
                other: seen.label.clone().into(),
                other_role: seen.role,
                likeness,
            });
        }
        self.remember(used, rows, whole);
        Ok(())
    }

    fn remember(&mut self, used: &UsedSeries<'_>, rows: &[u64], whole: u64) {
        let length = RUN_ROWS.min(rows.len());
        let mut moving = vec![0];
        for row in used.rows.clone().take(rows.len()) {
            moving.push(moving[moving.len() - 1] + usize::from(used.moves(row)));
        }
        let mut next = 0;
        for (start, hash) in rolling(rows, length) {
            if start >= next && 2 * (moving[start + length] - moving[start]) >= length {
                self.runs.entry((length, hash)).or_insert(self.seen.len());
                self.lengths.insert(length);
                next = start + (rows.len() / RUNS).max(1);
            }
        }
        let (label, rows) = (used.label.to_owned(), used.rows.clone());
        let pieces = Pieces::of(&used.series(), rows.clone());
        self.seen.push(Seen { label, role: used.role, whole, rows, pieces });
        if let Some(k) = self.seen.len().checked_sub(COMPARED + 1) {
            self.seen[k].pieces = Pieces::default();
        }
    }
}

/// The first row and the hash of each run of so many rows.
fn rolling(rows: &[u64], length: usize) -> impl Iterator<Item = (usize, u64)> + '_ {
    let power = (0..length).fold(1_u64, |power, _| power.wrapping_mul(BASE));
    let mut hash = 0_u64;
    rows.iter().enumerate().filter(move |_| length > 0).filter_map(move |(row, own)| {
        hash = hash.wrapping_mul(BASE).wrapping_add(*own);
        if row >= length {
            hash = hash.wrapping_sub(rows[row - length].wrapping_mul(power));
        }
        (row + 1 >= length).then(|| (row + 1 - length, hash))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Positions and measurements of one joint, 500 samples from the `from`-th on.
    fn series(from: usize) -> [Vec<Vec<f64>>; 2] {
        let of = |f: &dyn Fn(f64) -> f64| vec![(from..from + 500).map(|k| f(k as f64)).collect()];
        [of(&|k| (0.013 * k).sin()), of(&|k| (0.031 * k).cos() + (0.7 * k * k).sin())]
    }

    fn add(register: &mut SampleRegister, series: &[Vec<Vec<f64>>; 2], rows: Range<usize>) -> bool {
        let [motion, measured] = series;
        let time_s = &(0..motion[0].len()).map(|k| 0.01 * k as f64).collect::<Vec<_>>();
        register.add(&UsedSeries { label: "a", role: "calibration", time_s, motion, measured, rows }).is_ok()
    }

    #[test]
    fn copies_cut_or_whole_are_known_again() {
        let mut register = SampleRegister::default();
        assert!(add(&mut register, &series(0), 0..500));
        assert!(!add(&mut register, &series(0), 0..500), "a copy");
        assert!(!add(&mut register, &series(300), 0..500), "a copy that begins later");
        assert!(!add(&mut register, &series(300), 20..180), "a part of it");
        assert!(add(&mut register, &series(300), 210..500), "what comes after");
        assert!(add(&mut register, &series(900), 0..500), "another recording");
    }

    #[test]
    fn windows_of_one_recording_share_what_they_overlap_in() {
        // A motion that repeats itself bit for bit.
        let position = vec![(0..500).map(|k| f64::from(k % 100)).collect::<Vec<_>>()];
        let periodic = [position.clone(), position];
        let mut register = SampleRegister::default();
        assert!(add(&mut register, &periodic, 0..200) && add(&mut register, &periodic, 200..400));
        assert!(!add(&mut register, &periodic, 390..500));
        assert!(add(&mut register, &periodic, 399..500), "they share the sample between them");
    }

    #[test]
    fn a_robot_at_rest_is_not_another_recording_of_itself() {
        let rest = |samples| [vec![vec![0.5; samples]], vec![vec![1.5; samples]]];
        let mut register = SampleRegister::default();
        assert!(add(&mut register, &rest(400), 0..400) && add(&mut register, &rest(300), 0..300));
    }
}
