//! Whether there is enough to judge by.

use crate::error::DiagnosisError;
use crate::recordings::partition::{
    FEWEST_PIECES, Partition, end_of_fit, half_gap, is_judged, pieces, rows_needed,
};
use crate::recordings::rows::Role;
use crate::request::Question;

/// Whether the recordings of each kind can be cut into enough pieces of time together; `blocks` and `gap_s` are those of
/// [`Partition::new`].
pub(crate) fn check(question: &Question<'_>, blocks: usize, gap_s: f64) -> Result<(), DiagnosisError> {
    let has = |role: Role| question.recordings.iter().any(|r| r.role == role);
    let (targets, validated) = (has(Role::Target), has(Role::Validation));
    for role in [Role::Calibration, Role::Target] {
        let judged = is_judged(role, targets, validated);
        let mut cut = 0;
        let mut longest: Option<(f64, &str, f64)> = None;
        for recording in question.recordings.iter().filter(|r| r.role == role) {
            let segments = &recording.data.data.segments;
            let rows: usize = segments.iter().map(aurt_recording::Segment::rows).sum();
            let rate_hz = segments.last().map_or(1.0, |s| s.rate_hz / s.decimation as f64);
            let gap = half_gap(gap_s, rate_hz);
            cut += pieces(end_of_fit(rows, judged), gap, blocks).map_or(0, |p| p.0);
            let length_s = rows as f64 / rate_hz;
            if longest.is_none_or(|(most, ..)| length_s > most) {
                let needed_s = rows_needed(gap, judged) as f64 / rate_hz;
                longest = Some((length_s, &recording.data.name, needed_s));
            }
        }
        if let Some((length_s, name, needed_s)) = longest
            && cut < FEWEST_PIECES
        {
            return Err(DiagnosisError::Brief { recording: name.to_owned(), length_s, needed_s });
        }
    }
    Ok(())
}

/// What is said of recordings that are cut into fewer pieces than usual.
pub(crate) fn brief(partition: &Partition, recording: usize) -> Option<String> {
    let (cut, blocks) = (partition.pieces[recording], partition.blocks.len());
    match cut {
        _ if partition.end_of_fit[recording] == 0 || cut == blocks => None,
        0 => Some("is too short for a block of time; it was not used".to_owned()),
        _ => Some(format!(
            "is short and gives {cut} block{} of time instead of {blocks}: weak or rare effects cannot be \
             distinguished from chance in it",
            if cut == 1 { "" } else { "s" }
        )),
    }
}
