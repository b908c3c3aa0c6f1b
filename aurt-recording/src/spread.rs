//! Recordings of which only stretches are kept, spread evenly over them: all that they hold is read, memory is bounded.

use std::path::Path;

use crate::error::RecordingError;
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
    /// One of this many is kept; 0 where the recording is to stay whole.
    every: usize,
    next: usize,
    /// Those that are kept, with their places; none as long as `rest` is the whole.
    kept: Vec<(usize, Recording)>,
    /// The whole recording, or what the file's report says of it, without rows.
    rest: Recording,
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
        let (mut every, mut next, mut kept) = (1, 0, Vec::new());
        // Whole stretches a piece.
        let piece_rows = most_rows.clamp(1, usize::MAX / 2).next_multiple_of(STRETCH_ROWS);
        let rest = read_in_pieces(path, options, piece_rows, &mut |piece| {
            push(piece, (&mut every, &mut next, &mut kept), most_rows);
            Ok(())
        })?;
        if next == 0 {
            return Ok(Self { every, next, kept, rest }.at_most(most_rows));
        }
        push(&rest, (&mut every, &mut next, &mut kept), most_rows);
        Ok(Self { every, next, kept, rest: rest.rows(0..0) })
    }

    /// A recording of which nothing is left out, however long it is.
    #[must_use]
    pub const fn whole(recording: Recording) -> Self {
        Self { every: 0, next: 0, kept: Vec::new(), rest: recording }
    }

    /// Rows that are kept.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rest.samples() + rows(&self.kept)
    }

    /// Keeps no more than so many rows, one stretch at least.
    #[must_use]
    pub fn at_most(mut self, most_rows: usize) -> Self {
        if self.every == 0 || self.rows() <= most_rows {
            return self;
        }
        if self.next == 0 {
            push(&self.rest, (&mut self.every, &mut self.next, &mut self.kept), most_rows);
            self.rest = self.rest.rows(0..0);
        }
        thin(&mut self.every, &mut self.kept, most_rows);
        self
    }

    /// One recording, with gaps where stretches were left out; a remark of its report tells of them.
    #[must_use]
    pub fn into_recording(self) -> Recording {
        let (all, rows, every) = (self.rest.report.rows, self.rows(), self.every);
        let mut joined = self.rest;
        for (_, stretch) in self.kept {
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

/// Cuts a piece into stretches and keeps those whose turn it is.
fn push(
    piece: &Recording,
    (every, next, kept): (&mut usize, &mut usize, &mut Vec<(usize, Recording)>),
    most_rows: usize,
) {
    // Readers hold back a row here and there, so that pieces are no exact multiples.
    let samples = piece.samples();
    let stretches = ((samples + STRETCH_ROWS / 2) / STRETCH_ROWS).max(1);
    for k in 0..stretches {
        if next.is_multiple_of(*every) {
            kept.push((*next, piece.rows(k * samples / stretches..(k + 1) * samples / stretches)));
        }
        *next += 1;
        thin(every, kept, most_rows);
    }
}

/// Keeps every second stretch of those that are kept, until there are no more rows than that, or one stretch.
fn thin(every: &mut usize, kept: &mut Vec<(usize, Recording)>, most_rows: usize) {
    while kept.len() > 1 && rows(kept) > most_rows {
        *every *= 2;
        kept.retain(|(index, _)| index.is_multiple_of(*every));
    }
}

fn rows(kept: &[(usize, Recording)]) -> usize {
    kept.iter().map(|(_, stretch)| stretch.samples()).sum()
}
