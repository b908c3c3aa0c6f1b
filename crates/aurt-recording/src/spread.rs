//! Recordings of which only stretches are kept, spread evenly over them: all that they hold is read, memory is bounded.

use std::path::Path;

use crate::{
    ReadOptions, Recording, RecordingError,
    format::{read_in_pieces, read_recording},
};

/// Rows of a stretch: 16 s at 1 kHz, several motions of most robots, hundreds of times what filters need.
const STRETCH_ROWS: usize = 1 << 14;

/// Reads a recording as [`read_recording`] does; of one with more than `most_rows` rows it keeps stretches of about 16 384, every
/// second one, every fourth, …, until what is kept is no more than that (and one stretch at least). Between them the recording
/// has gaps; a remark of its report tells of them.
///
/// Files that are [joined](crate::RecordedAs::joined) are read whole.
///
/// # Errors
/// As [`read_recording`].
pub fn read_spread(
    path: &Path,
    options: &ReadOptions,
    most_rows: usize,
) -> Result<Recording, RecordingError> {
    if !options.recorded.joined.is_empty() {
        return read_recording(path, options);
    }
    let mut spread = Spread { most_rows, every: 1, next: 0, kept: Vec::new() };
    // Whole stretches a piece.
    let piece_rows = most_rows.clamp(1, usize::MAX / 2).next_multiple_of(STRETCH_ROWS);
    let last = read_in_pieces(path, options, piece_rows, &mut |piece| {
        spread.push(piece);
        Ok(())
    })?;
    if spread.next == 0 && last.samples() <= most_rows.max(STRETCH_ROWS) {
        return Ok(last);
    }
    spread.push(&last);
    Ok(spread.joined(last))
}

/// Stretches that are kept, with their place among all.
struct Spread {
    most_rows: usize,
    every: usize,
    next: usize,
    kept: Vec<(usize, Recording)>,
}

impl Spread {
    fn push(&mut self, piece: &Recording) {
        // Readers hold back a row here and there, so that pieces are no exact multiples.
        let samples = piece.samples();
        let stretches = ((samples + STRETCH_ROWS / 2) / STRETCH_ROWS).max(1);
        for k in 0..stretches {
            if self.next.is_multiple_of(self.every) {
                let range = k * samples / stretches..(k + 1) * samples / stretches;
                self.kept.push((self.next, piece.rows(range)));
            }
            self.next += 1;
            while self.kept.len() > 1 && self.rows() > self.most_rows {
                self.every *= 2;
                let every = self.every;
                self.kept.retain(|(index, _)| index.is_multiple_of(every));
            }
        }
    }

    fn rows(&self) -> usize {
        self.kept.iter().map(|(_, stretch)| stretch.samples()).sum()
    }

    /// One recording; what `last` says of the file is said of it.
    fn joined(self, last: Recording) -> Recording {
        let (all, rows, every) = (last.report.rows, self.rows(), self.every);
        let mut joined = last.rows(0..0);
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
