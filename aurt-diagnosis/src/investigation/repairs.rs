//! Whether the repair of faulty recordings makes a difference.

use crate::effects::{dropped_samples, saturation};
use crate::error::DiagnosisError;
use crate::evidence::baseline::{Baseline, evaluate_all};
use crate::evidence::judged::prepare;
use crate::faults::Fault;
use crate::recordings::rows::{Fit, RecordingRows, Role};
use crate::request::Question;
use crate::vocabulary::Effect;

/// A repair matters if it lowers the mean squared residual of some joint by this share.
const REPAIRED: f64 = 0.1;

/// The faults of recordings, and whether their repair matters.
pub(crate) struct JudgedFaults {
    /// The faults. Those of an effect whose repair matters suffice, however few rows they concern.
    pub(crate) faults: Vec<Fault>,
    /// True if the repair of any effect matters.
    pub(crate) matter: bool,
}

impl JudgedFaults {
    /// Judges the faults of repaired recordings: of each effect, whether the model in question fits them better than recordings
    /// that are examined like them but for its repair.
    pub(crate) fn new(as_recorded: &Question<'_>, repaired: &Question<'_>) -> Result<Self, DiagnosisError> {
        let spoilt = repaired.recordings.iter().filter_map(|r| r.spoilt.as_ref());
        let mut faults: Vec<Fault> = spoilt.flat_map(|s| s.faults.faults.iter().cloned()).collect();
        if faults.is_empty() {
            return Ok(Self { faults, matter: false });
        }
        let after = mean_squares(repaired)?;
        let mut matter = false;
        for effect in [&dropped_samples::EFFECT, &saturation::EFFECT] {
            if faults.iter().all(|f| f.effect != effect) {
                continue;
            }
            let before = mean_squares_without_repair(as_recorded, effect)?;
            if before.iter().zip(&after).any(|(before, after)| *after < (1.0 - REPAIRED) * before) {
                faults.iter_mut().filter(|f| f.effect == effect).for_each(|f| f.suffices = true);
                matter = true;
            }
        }
        Ok(Self { faults, matter })
    }
}

/// The mean squares of recordings without the repair of one effect.
fn mean_squares_without_repair(
    as_recorded: &Question<'_>,
    effect: &Effect,
) -> Result<Vec<f64>, DiagnosisError> {
    let without: Vec<String> = as_recorded.without.iter().cloned().chain([effect.id.to_owned()]).collect();
    let recordings =
        as_recorded.recordings.iter().map(|r| r.repaired(&without)).collect::<Result<Vec<_>, _>>()?;
    mean_squares(&Question { recordings: &recordings, ..*as_recorded })
}

/// Mean squared residual of each joint under the model in question, over what is not for validation.
fn mean_squares(question: &Question<'_>) -> Result<Vec<f64>, DiagnosisError> {
    let baseline = Baseline::new(question)?;
    let fit = Fit { model: question.model, load: &baseline.load, coefficients: &baseline.coefficients };
    let mut rows = evaluate_all(question, &fit)?;
    prepare(question, &baseline, question.model, &mut rows);
    let asked: Vec<&RecordingRows> = rows.iter().filter(|r| r.role != Role::Validation).collect();
    let joints = question.model.joints();
    Ok((0..joints)
        .map(|j| {
            let columns = question.model.row_columns(j);
            let value = |c: &usize| if baseline.frozen { 0.0 } else { baseline.coefficients[*c] };
            let (sum, count) = asked.iter().fold((0.0, 0.0), |(sum, count), r| {
                let residual = r.joints[j].residual(columns.iter().map(value));
                let power: f64 = residual.iter().map(|e| e * e).sum();
                (sum + power, count + r.joints[j].counted(0, r.rows()))
            });
            sum / f64::max(count, 1.0)
        })
        .collect())
}
