//! Columns of laws whose shapes were estimated, in the rows that confirm.

use aurt_plugins::Registry;

use crate::error::DiagnosisError;
use crate::hypotheses::candidates::{Candidate, build_term};
use crate::recordings::divided::ConfirmRows;
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
    let Addition::Term(configuration) = &candidate.proposal.addition else { return Ok(()) };
    if candidate.proposal.shapes.is_empty() {
        return Ok(());
    }
    let term = build_term(registry, candidate.effect, configuration)?;
    let joints = term.joints(layout.rows.len());
    for (r, recording) in question.recordings.iter().enumerate() {
        if confirm.to_judge()[r].rows() == 0 {
            continue;
        }
        let series = term_rows(&*term, &**question.model.rigid_body(), &recording.data.data)?;
        for (joint, columns) in joints.iter().zip(&series) {
            for (column, values) in candidate.columns.iter().zip(columns) {
                let place = layout.rows[*joint].iter().position(|c| c == column);
                let rest = values.get(partition.end_of_fit[r]..);
                if let (Some(place), Some(rest)) = (place, rest) {
                    confirm.set_column(r, *joint, place, rest);
                }
            }
        }
    }
    Ok(())
}
