//! Columns of laws whose shapes were estimated.

use aurt_plugins::Registry;

use crate::error::DiagnosisError;
use crate::hypotheses::candidates::{Candidate, build_term};
use crate::recordings::divided::{ConfirmRows, FitRows};
use crate::recordings::partition::Partition;
use crate::recordings::rows::Layout;
use crate::recordings::term_rows::term_rows;
use crate::request::Question;
use crate::vocabulary::Addition;

/// Evaluates a law with the shapes that were estimated on the rows that fit over the rows that confirm, which still have
/// its columns with the shapes that the search started from.
///
/// # Errors
/// What the law and the filter report.
pub(crate) fn reshape(
    confirm: &mut ConfirmRows,
    candidate: &Candidate,
    question: &Question<'_>,
    registry: &Registry,
    layout: &Layout,
    partition: &Partition,
) -> Result<(), DiagnosisError> {
    put(candidate, question, registry, layout, |r, joint, place, values| {
        if let Some(rest) = values.get(partition.end_of_fit[r]..) {
            confirm.set_column(r, joint, place, rest);
        }
    })
}

/// [`reshape`] of the rows that fit as well: a search that changed no claim has left the law with other shapes.
///
/// # Errors
/// What the law and the filter report.
pub(super) fn restore(
    (fit, confirm): (&mut FitRows, &mut ConfirmRows),
    candidate: &Candidate,
    question: &Question<'_>,
    registry: &Registry,
    layout: &Layout,
    partition: &Partition,
) -> Result<(), DiagnosisError> {
    reshape(confirm, candidate, question, registry, layout, partition)?;
    put(candidate, question, registry, layout, |r, joint, place, values| {
        fit[r].joints[joint].set_column(place, values);
    })
}

/// Evaluates the columns of a law with shapes over all rows: recording, joint, place, and values.
fn put(
    candidate: &Candidate,
    question: &Question<'_>,
    registry: &Registry,
    layout: &Layout,
    mut column_of: impl FnMut(usize, usize, usize, &[f64]),
) -> Result<(), DiagnosisError> {
    let Addition::Term(configuration) = &candidate.proposal.addition else { return Ok(()) };
    if candidate.proposal.shapes.is_empty() {
        return Ok(());
    }
    let term = build_term(registry, candidate.effect, configuration)?;
    let joints = term.joints(layout.rows.len());
    for (r, recording) in question.recordings.iter().enumerate() {
        let series = term_rows(&*term, &**question.model.rigid_body(), &recording.data.data)?;
        for (joint, columns) in joints.iter().zip(&series) {
            for (column, values) in candidate.columns.iter().zip(columns) {
                if let Some(place) = layout.rows[*joint].iter().position(|c| c == column) {
                    column_of(r, *joint, place, values);
                }
            }
        }
    }
    Ok(())
}
