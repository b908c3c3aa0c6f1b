//! Gears, and the fit of the model without what they do to the measurement.

use crate::error::DiagnosisError;
use crate::evidence::baseline::{Baseline, partition};
use crate::evidence::judged::Judged;
use crate::recordings::rows::{Fit, RecordingRows, Role};
use crate::request::{Question, QuestionedRecording};
use crate::transmission::{Gears, find_gears, undone};

/// A model fitted without what gears do, and what it left with it.
pub(super) struct WithoutGears {
    pub judged: Judged,
    pub gears: Gears,
    /// The recordings without the torque of confirmed gears, if there are any.
    pub recordings: Option<Vec<QuestionedRecording>>,
    pub before: Option<BeforeGears>,
}

/// What the model in question left of the measurement while the gears' torque was in it, root mean square, joint by joint.
#[derive(Debug, Clone, PartialEq)]
pub struct BeforeGears {
    /// Of the recordings that are not for validation.
    pub baseline_rms: Vec<f64>,
    /// Of the rows that take no part in fits.
    pub held_out_rms: Vec<f64>,
}

/// A gear that the model lacks biases the fit, and the fit the gear: so often they take turns.
const TURNS: usize = 2;

/// Looks for gears in what a model leaves, and fits the model again without their torque; `of_all` says whether it is to be
/// fitted to all recordings.
pub(super) fn without_gears(
    question: &Question<'_>,
    mut judged: Judged,
    of_all: bool,
) -> Result<WithoutGears, DiagnosisError> {
    let mut gears = Gears::default();
    let mut recordings = None;
    let mut before = None;
    for turn in 0..TURNS {
        let baseline = &judged.baseline;
        let fit = Fit { model: question.model, load: &baseline.load, coefficients: &baseline.coefficients };
        let inertial: Vec<(usize, f64)> = question
            .model
            .base()
            .columns
            .iter()
            .copied()
            .zip(baseline.coefficients.iter().copied())
            .collect();
        let found = find_gears(question, &fit, &inertial)?;
        let confirmed = found.found.iter().any(|g| g.confirmed);
        if turn == 0 || confirmed {
            gears = found;
        }
        if !confirmed {
            break;
        }
        let freed = undone(question, &fit, &inertial, &gears.found)?;
        if turn == 0 {
            before = Some(left(question, &judged));
        }
        let corrected = Question { recordings: &freed, ..*question };
        let baseline = if of_all { Baseline::of_all(&corrected)? } else { Baseline::new(&corrected)? };
        judged = Judged::new(&corrected, baseline)?;
        recordings = Some(freed);
    }
    Ok(WithoutGears { judged, gears, recordings, before })
}

/// What a model leaves of its own rows.
fn left(question: &Question<'_>, judged: &Judged) -> BeforeGears {
    let partition = partition(question, &judged.own_rows);
    let asked = |r: &RecordingRows| r.role != Role::Validation;
    let fitted: Vec<_> = (0..judged.own_rows.len())
        .filter(|r| asked(&judged.own_rows[*r]))
        .map(|r| (r, 0, judged.own_rows[r].rows()))
        .collect();
    let rms = |parts: &[(usize, usize, usize)]| -> Vec<f64> {
        (0..question.model.joints())
            .map(|j| {
                let columns = question.model.row_columns(j);
                let value =
                    |c: &usize| if judged.baseline.frozen { 0.0 } else { judged.baseline.coefficients[*c] };
                let (power, count) = parts.iter().fold((0.0, 0.0), |(power, count), (r, start, end)| {
                    let joint = &judged.own_rows[*r].joints[j];
                    let residual = joint.residual(columns.iter().map(value));
                    let sum: f64 = residual[*start..*end].iter().map(|e| e * e).sum();
                    (power + sum, count + joint.counted(*start, *end))
                });
                (power / f64::max(count, 1.0)).sqrt()
            })
            .collect()
    };
    BeforeGears { baseline_rms: rms(&fitted), held_out_rms: rms(&partition.held_out) }
}
