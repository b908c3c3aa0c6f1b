//! Columns of laws whose shapes were estimated.

use std::collections::BTreeSet;

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
/// its columns with the shapes that the search started from. With the rows that fit, these get the columns as well.
pub(super) fn reshape(
    (mut fit, confirm): (Option<&mut FitRows>, &mut ConfirmRows),
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
        if fit.is_none() && confirm.to_judge()[r].rows() == 0 {
            continue;
        }
        let series = term_rows(&*term, &**question.model.rigid_body(), &recording.data.data)?;
        for (joint, columns) in joints.iter().zip(&series) {
            for (column, values) in candidate.columns.iter().zip(columns) {
                let Some(place) = layout.rows[*joint].iter().position(|c| c == column) else { continue };
                if let Some(fit) = fit.as_deref_mut() {
                    fit[r].joints[*joint].set_column(place, values);
                }
                if let Some(rest) = values.get(partition.end_of_fit[r]..) {
                    confirm.set_column(r, *joint, place, rest);
                }
            }
        }
    }
    Ok(())
}

/// [`reshape`] of the rows that confirm for chosen candidates, and for the laws of any joint beside which delays are judged.
pub(crate) fn reshape_judged(
    confirm: &mut ConfirmRows,
    candidates: &[Candidate],
    chosen: impl Iterator<Item = usize>,
    question: &Question<'_>,
    registry: &Registry,
    layout: &Layout,
    partition: &Partition,
) -> Result<(), DiagnosisError> {
    let staying = (0..candidates.len()).filter(|k| candidates[*k].effect.stays_beside_delays);
    let judged: BTreeSet<usize> = chosen.chain(staying).collect();
    judged
        .into_iter()
        .try_for_each(|k| reshape((None, confirm), &candidates[k], question, registry, layout, partition))
}
