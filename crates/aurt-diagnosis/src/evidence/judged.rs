//! The model in question, judged by the noise that it would leave.

use aurt_traits::RobotModel;

use crate::error::DiagnosisError;
use crate::evidence::baseline::{BLOCKS, Baseline, evaluate_all};
use crate::noise::floor::noise_floor;
use crate::recordings::rows::{Fit, JointRows, RecordingRows, Role};
use crate::request::Question;

/// Fewest rows that a block of time must have to judge anything.
const FEWEST_ROWS_PER_BLOCK: usize = 8;

/// A model in question, its rows, and the noise that it leaves.
pub(crate) struct Judged {
    pub(crate) baseline: Baseline,
    /// Its rows of each recording.
    pub(crate) own_rows: Vec<RecordingRows>,
    /// Mean square of what noise leaves, `[recording][joint]`.
    pub(crate) floors: Vec<Vec<f64>>,
}

impl Judged {
    /// Evaluates a baseline.
    ///
    /// # Errors
    /// Recordings too short to be cut in blocks; what evaluation reports.
    pub(crate) fn new(question: &Question<'_>, baseline: Baseline) -> Result<Self, DiagnosisError> {
        let fit = Fit { model: question.model, load: &baseline.load, coefficients: &baseline.coefficients };
        let mut own_rows = evaluate_all(question, question.model, &fit)?;
        let asked = own_rows.iter().filter(|r| r.role != Role::Validation);
        if let Some(short) = asked.into_iter().find(|r| r.rows() < FEWEST_ROWS_PER_BLOCK * BLOCKS) {
            return Err(DiagnosisError::TooShort {
                recording: short.name.clone(),
                rows: short.rows(),
                blocks: BLOCKS,
            });
        }
        prepare(question, &baseline, question.model, &mut own_rows);
        let floors = question
            .recordings
            .iter()
            .zip(&own_rows)
            .map(|(r, rows)| noise_floor(&r.raw, &r.data.data, &r.options, &fit, rows))
            .collect::<Result<Vec<_>, _>>()?;
        Ok(Self { baseline, own_rows, floors })
    }

    /// Whether on some joint the noise is said to exceed all that was measured, noise included.
    pub(crate) fn noise_exceeds_all(&self) -> bool {
        self.own_rows.iter().zip(&self.floors).filter(|(r, _)| r.role != Role::Validation).any(
            |(rows, floors)| {
                let moving = |(joint, _): &(&JointRows, &f64)| joint.counted(0, rows.rows()) > 0.0;
                rows.joints.iter().zip(floors).filter(moving).any(|(joint, floor)| {
                    let power: f64 = joint.measurement.iter().map(|m| m * m).sum();
                    *floor > INCREDIBLE * power / joint.counted(0, rows.rows()).max(1.0)
                })
            },
        )
    }
}

/// Noise of this many times the power of the measurement is none.
const INCREDIBLE: f64 = 4.0;

/// Turns rows into what is asked about: what a frozen model or another simulator leaves.
pub(crate) fn prepare(
    question: &Question<'_>,
    baseline: &Baseline,
    model: &RobotModel,
    rows: &mut [RecordingRows],
) {
    if !baseline.frozen {
        return;
    }
    // Without targets, what a given model leaves of any recording is the question.
    let targets = question.recordings.iter().any(|r| r.role == Role::Target);
    for (recording, rows) in question.recordings.iter().zip(rows) {
        if rows.role == Role::Calibration && !targets {
            rows.role = Role::Target;
        }
        for j in 0..rows.joints.len() {
            let left = match &recording.simulated {
                Some(simulated) => crate::request::simulated::rows_left(recording, rows, simulated, j),
                None => {
                    let own = question.model.parameters().len();
                    let columns = model.row_columns(j);
                    rows.joints[j].residual(
                        columns.iter().map(|c| if *c < own { baseline.coefficients[*c] } else { 0.0 }),
                    )
                }
            };
            rows.joints[j].measurement = left;
            rows.joints[j].silence();
        }
    }
}
