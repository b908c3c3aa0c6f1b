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
}

/// Share of every recording's end that is held out where no validation recordings are given.
const HELD_OUT_TAIL: f64 = 0.25;

impl Partition {
    /// Holds out the validation recordings, or, where there are none (`validated` is false), the last quarter of every recording, and
    /// cuts the rest in `blocks` blocks of contiguous time with `gap_s` dropped between neighbours, so that the
    /// filters' memory does not tie them together.
    #[must_use]
    pub fn new(recordings: &[RecordingRows], blocks: usize, gap_s: f64, validated: bool) -> Self {
        let mut partition =
            Self { blocks: vec![Vec::new(); blocks], held_out: Vec::new(), held_out_names: Vec::new() };
        let targets = recordings.iter().any(|r| r.role == Role::Target);
        for (r, recording) in recordings.iter().enumerate() {
            let rows = recording.rows();
            if recording.role == Role::Validation {
                partition.held_out.push((r, 0, rows));
                partition.held_out_names.push(recording.name.clone());
                continue;
            }
            let gap = (gap_s * recording.rate_hz / 2.0).ceil() as usize;
            let judged = !validated && (recording.role == Role::Target || !targets);
            let end_of_fit = if judged { (rows as f64 * (1.0 - HELD_OUT_TAIL)) as usize } else { rows };
            if judged {
                partition.held_out.push(((r), (end_of_fit + gap).min(rows), rows));
                partition.held_out_names.push(format!(
                    "{} from {:.1} s",
                    recording.name,
                    recording.time_s.get(end_of_fit).map_or(0.0, |t| t - recording.time_s[0])
                ));
            }
            for (f, block) in partition.blocks.iter_mut().enumerate() {
                let (start, end) = (end_of_fit * f / blocks, end_of_fit * (f + 1) / blocks);
                let start = if f == 0 { start } else { start + gap };
                let end = end.saturating_sub(gap);
                if start < end {
                    block.push((r, start, end));
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
