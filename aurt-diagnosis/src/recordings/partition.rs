use crate::recordings::rows::{RecordingRows, Role};

/// Rows of a recording: (recording, first row, end row).
pub type Part = (usize, usize, usize);

/// Which rows select and fit, in blocks of contiguous time, and which only judge.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Partition {
    /// The blocks for cross-validation; rows in the gaps between them belong to none.
    pub blocks: Vec<Vec<Part>>,
    /// Rows that take no part in selection or fitting.
    pub held_out: Vec<Part>,
    /// What the held-out rows are, in words.
    pub held_out_names: Vec<String>,
    /// Into how many pieces each recording is cut; zero where it is too short for one.
    pub pieces: Vec<usize>,
    /// End of the rows of each recording that may fit.
    pub end_of_fit: Vec<usize>,
}

/// Share of every recording's end that is held out where no validation recordings are given.
pub(crate) const HELD_OUT_TAIL: f64 = 0.25;

/// Fewest rows that a piece must keep between its gaps: fewer say nothing of their own error.
pub(crate) const FEWEST_ROWS: usize = 8;

/// Gaps may shrink to this share: two periods of f_dyn are asked for, and the filters' answer to an impulse is over
/// after half of one.
const SHORTEST_GAP: f64 = 0.25;

/// Fewest pieces of time that a question can be judged on: with fewer, what is left out is most of what there is.
pub(crate) const FEWEST_PIECES: usize = 3;

impl Partition {
    /// Holds out the validation recordings, or, where there are none (`validated` is false), the last quarter of every
    /// recording, and cuts the rest in `blocks` blocks of contiguous time with `gap_s` dropped between neighbours, so
    /// that the filters' memory does not tie them together.
    ///
    /// A recording too short for that has smaller gaps, down to a quarter, and then fewer pieces.
    pub fn new(recordings: &[RecordingRows], blocks: usize, gap_s: f64, validated: bool) -> Self {
        let count = recordings.len();
        let mut partition = Self {
            blocks: vec![Vec::new(); blocks],
            held_out: Vec::new(),
            held_out_names: Vec::new(),
            pieces: vec![0; count],
            end_of_fit: vec![0; count],
        };
        let targets = recordings.iter().any(|r| r.role == Role::Target);
        for (r, recording) in recordings.iter().enumerate() {
            let rows = recording.rows();
            if recording.role == Role::Validation {
                partition.held_out.push((r, 0, rows));
                partition.held_out_names.push(recording.name.clone());
                continue;
            }
            let gap = half_gap(gap_s, recording.rate_hz);
            let judged = is_judged(recording.role, targets, validated);
            let end_of_fit = end_of_fit(rows, judged);
            partition.end_of_fit[r] = end_of_fit;
            if judged {
                partition.held_out.push((r, (end_of_fit + gap).min(rows), rows));
                partition.held_out_names.push(format!(
                    "{} from {:.1} s",
                    recording.name,
                    recording.time_s.get(end_of_fit).map_or(0.0, |t| t - recording.time_s[0])
                ));
            }
            let Some((pieces, gap)) = pieces(end_of_fit, gap, blocks) else { continue };
            partition.pieces[r] = pieces;
            for f in 0..pieces {
                let (start, end) = (end_of_fit * f / pieces, end_of_fit * (f + 1) / pieces);
                let start = if f == 0 { start } else { start + gap };
                let end = end.saturating_sub(gap);
                // Short recordings lie in different blocks, as far as there are.
                let block = if pieces == blocks { f } else { (r + f * blocks / pieces) % blocks };
                if start < end {
                    partition.blocks[block].push((r, start, end));
                }
            }
        }
        partition
    }

    /// All rows that select and fit.
    pub fn fitted(&self) -> impl Iterator<Item = Part> + '_ {
        self.blocks.iter().flatten().copied()
    }
}

/// Whether a recording's own end judges, since nothing else does.
pub(crate) fn is_judged(role: Role, targets: bool, validated: bool) -> bool {
    !validated && (role == Role::Target || role == Role::Calibration && !targets)
}

pub(crate) fn end_of_fit(rows: usize, judged: bool) -> usize {
    if judged { (rows as f64 * (1.0 - HELD_OUT_TAIL)) as usize } else { rows }
}

/// Rows dropped on either side of a cut.
pub(crate) fn half_gap(gap_s: f64, rate_hz: f64) -> usize {
    (gap_s * rate_hz / 2.0).ceil() as usize
}

/// How many pieces a recording of so many rows is cut into, and the rows dropped on either side of a cut.
pub(crate) fn pieces(rows: usize, gap: usize, blocks: usize) -> Option<(usize, usize)> {
    let shortest = (gap as f64 * SHORTEST_GAP).ceil() as usize;
    let fits = |pieces: usize, gap: usize| rows / pieces >= FEWEST_ROWS + 2 * gap;
    let whole = [gap, gap.div_ceil(2), shortest].into_iter().map(|gap| (blocks, gap));
    let fewer = (1..blocks).rev().map(|pieces| (pieces, shortest));
    whole.chain(fewer).find(|(pieces, gap)| fits(*pieces, *gap))
}

/// Rows that a recording needs to be cut into the fewest pieces that can judge.
pub(crate) fn rows_needed(gap: usize, judged: bool) -> usize {
    let shortest = (gap as f64 * SHORTEST_GAP).ceil() as usize;
    let fitted = FEWEST_PIECES * (FEWEST_ROWS + 2 * shortest);
    if judged { (fitted as f64 / (1.0 - HELD_OUT_TAIL)).ceil() as usize + 1 } else { fitted }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording(role: Role, rows: usize) -> RecordingRows {
        RecordingRows {
            name: "r.csv".into(),
            role,
            rate_hz: 10.0,
            time_s: (0..rows).map(|k| k as f64 / 10.0).collect(),
            segment_starts: vec![0, rows],
            joints: Vec::new(),
        }
    }

    #[test]
    fn a_long_recording_has_all_blocks_with_whole_gaps() {
        let partition = Partition::new(&[recording(Role::Calibration, 400)], 6, 0.8, false);
        assert_eq!((partition.pieces[0], partition.end_of_fit[0]), (6, 300));
        assert_eq!(partition.blocks[1], [(0, 54, 96)]);
        assert_eq!(partition.held_out, [(0, 304, 400)]);
    }

    #[test]
    fn a_short_recording_has_smaller_gaps_then_fewer_blocks_then_none() {
        let pieces = |rows: usize| {
            let partition = Partition::new(&[recording(Role::Calibration, rows)], 6, 0.8, true);
            let filled = partition.blocks.iter().filter(|b| !b.is_empty()).count();
            assert_eq!(filled, partition.pieces[0], "{rows}");
            assert!(partition.fitted().all(|(_, start, end)| end - start >= FEWEST_ROWS), "{rows}");
            filled
        };
        assert_eq!([96, 95, 60, 59, 30, 29, 10, 9].map(pieces), [6, 6, 6, 5, 3, 2, 1, 0]);
        let needed = rows_needed(4, true);
        assert_eq!(super::pieces(end_of_fit(needed, true), 4, 6).map(|p| p.0), Some(FEWEST_PIECES));
    }

    #[test]
    fn short_recordings_beside_each_other_are_left_out_in_turn() {
        let both = [recording(Role::Calibration, 12), recording(Role::Calibration, 12)];
        let partition = Partition::new(&both, 6, 0.8, true);
        assert_eq!(partition.blocks.iter().filter(|b| !b.is_empty()).count(), 2);
    }
}
