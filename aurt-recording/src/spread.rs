//! Recordings of which only stretches are kept, spread evenly over them: all that they hold is read, memory is bounded.

use std::path::Path;

use crate::error::RecordingError;
use crate::format::Reading;
use crate::formats::read_in_pieces;
use crate::read_options::ReadOptions;
use crate::reading::read_recording;
use crate::recording::Recording;

/// Rows of a stretch: 16 s at 1 kHz, several motions of most robots, hundreds of times what filters need.
const STRETCH_ROWS: usize = 1 << 14;

/// A recording, or stretches of about 16 384 rows of a long one: every second one, every fourth, …, from its beginning to its
/// end.
#[derive(Debug)]
pub struct Stretches {
    kept: KeptStretches,
    /// The whole recording as long as nothing is cut, or what the file's report says of it, without rows.
    rest: Recording,
}

/// Stretches that are kept, with their places.
#[derive(Debug, Default)]
struct KeptStretches {
    /// One of this many is kept; 0 where the recording is to stay whole.
    every: usize,
    next: usize,
    stretches: Vec<(usize, Recording)>,
}

impl Stretches {
    /// Reads a recording as [`read_recording`] does and keeps at most `most_rows` rows of it, one stretch at least. Memory
    /// grows with what is kept and not with the file. Files that are [joined](crate::RecordedAs::joined) stay whole.
    ///
    /// # Errors
    /// As [`read_recording`].
    pub fn read(path: &Path, options: &ReadOptions, most_rows: usize) -> Result<Self, RecordingError> {
        if !options.recorded.joined.is_empty() {
            return read_recording(path, options).map(Self::whole);
        }
        let mut kept = KeptStretches { every: 1, ..KeptStretches::default() };
        // Whole stretches a piece.
        let piece_rows = most_rows.clamp(1, usize::MAX / 2).next_multiple_of(STRETCH_ROWS);
        let mut visit = |piece: &Recording| {
            kept.push(piece, most_rows);
            Ok(())
        };
        let rest = read_in_pieces(path, Reading { options, piece_rows, visit: &mut visit })?;
        if kept.next == 0 {
            return Ok(Self { kept, rest }.at_most(most_rows));
        }
        kept.push(&rest, most_rows);
        Ok(Self { kept, rest: rest.rows(0..0) })
    }

    /// A recording of which nothing is left out, however long it is.
    pub fn whole(recording: Recording) -> Self {
        Self { kept: KeptStretches::default(), rest: recording }
    }

    /// Rows that are kept.
    pub fn rows(&self) -> usize {
        self.rest.samples() + self.kept.rows()
    }

    /// Keeps no more than so many rows, one stretch at least.
    #[must_use]
    pub fn at_most(mut self, most_rows: usize) -> Self {
        if self.kept.every == 0 || self.rows() <= most_rows {
            return self;
        }
        if self.kept.next == 0 {
            self.kept.push(&self.rest, most_rows);
            self.rest = self.rest.rows(0..0);
        }
        self.kept.thin(most_rows);
        self
    }

    /// One recording, with gaps where stretches were left out; a remark of its report tells of them.
    pub fn into_recording(self) -> Recording {
        let (all, rows, every) = (self.rest.report.rows, self.rows(), self.kept.every);
        let mut joined = self.rest;
        for (_, stretch) in self.kept.stretches {
            if every > 1
                && let (Some(before), Some(after)) = (joined.time_s.last(), stretch.time_s.first())
            {
                joined.report.left_out_s.push([*before, *after]);
            }
            joined.extend(stretch);
        }
        if every > 1 {
            joined.report.remarks.push(format!(
                "{rows} of {all} rows were looked at: every {every}th of its stretches of about {STRETCH_ROWS} rows"
            ));
        }
        joined
    }
}

impl KeptStretches {
    /// Cuts a piece into stretches and keeps those whose turn it is.
    fn push(&mut self, piece: &Recording, most_rows: usize) {
        // Readers hold back a row here and there, so that pieces are no exact multiples.
        let samples = piece.samples();
        let count = ((samples + STRETCH_ROWS / 2) / STRETCH_ROWS).max(1);
        for k in 0..count {
            if self.next.is_multiple_of(self.every) {
                let stretch = piece.rows(k * samples / count..(k + 1) * samples / count);
                self.stretches.push((self.next, stretch));
            }
            self.next += 1;
            self.thin(most_rows);
        }
    }

    /// Keeps every second stretch of those that are kept, until there are no more rows than that, or one stretch.
    fn thin(&mut self, most_rows: usize) {
        while self.stretches.len() > 1 && self.rows() > most_rows {
            self.every *= 2;
            self.stretches.retain(|(index, _)| index.is_multiple_of(self.every));
        }
    }

    fn rows(&self) -> usize {
        self.stretches.iter().map(|(_, stretch)| stretch.samples()).sum()
    }
}
