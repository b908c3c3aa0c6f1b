//! The model in question, judged by the noise that it would leave.

use aurt_recording::Preprocessed;
use aurt_traits::{RobotModel, RobotNames};
use rayon::prelude::*;

use crate::error::DiagnosisError;
use crate::evidence::baseline::{Baseline, evaluate_all};
use crate::evidence::given::GivenCovariance;
use crate::evidence::residuals::residuals;
use crate::hypotheses::group::Switch;
use crate::noise::floor::{bounded, noise_floor};
use crate::noise::instrument::hold_to_reference;
use crate::noise::spectrum::RecordingNoise;
use crate::recordings::rows::{Fit, Layout, RecordingRows, Role};
use crate::request::Question;

/// A model in question, its rows, and the noise that it leaves.
pub(crate) struct Judged {
    pub(crate) baseline: Baseline,
    pub(crate) own_rows: Vec<RecordingRows>,
    /// Mean square of what noise leaves, `[recording][joint]`.
    pub(crate) floors: Vec<Vec<f64>>,
    /// The noise of each recording under the baseline.
    pub(crate) noise: Vec<RecordingNoise>,
    /// Whether on some joint of a recording that is not for validation the noise was estimated higher than all that
    /// was measured, noise included.
    pub(crate) noise_exceeds_all: bool,
    /// Where the noise was estimated higher than what is left.
    pub(crate) notes: Vec<String>,
}

impl Judged {
    /// Evaluates a baseline.
    pub(crate) fn new(question: &Question<'_>, baseline: Baseline) -> Result<Self, DiagnosisError> {
        let fit = Fit { model: question.model, load: &baseline.load, coefficients: &baseline.coefficients };
        let mut own_rows = evaluate_all(question, &fit)?;
        prepare(question, &baseline, question.model, &mut own_rows);
        let mut noise = question
            .recordings
            .par_iter()
            .map(|r| RecordingNoise::evaluate(&r.raw, &r.data.data, &r.options, &fit))
            .collect::<Result<Vec<_>, _>>()?;
        let data: Vec<&Preprocessed> = question.recordings.iter().map(|r| &r.data.data).collect();
        hold_to_reference(&mut noise, &data, |r| own_rows[r].role == Role::Calibration);
        let given = question.frozen.and_then(GivenCovariance::of);
        let mut floors = Vec::new();
        let mut notes = Vec::new();
        let mut noise_exceeds_all = false;
        for ((recording, rows), noise) in question.recordings.iter().zip(&own_rows).zip(&noise) {
            let mut floor = noise_floor(noise, &recording.data.data, rows)?;
            noise_exceeds_all |= exceeds_all(rows, &floor);
            let left = left(question, &baseline, rows);
            notes.extend(bounded(&rows.name, &mut floor, &left, question.names()));
            if let Some(given) = &given {
                for (j, (floor, left)) in floor.iter_mut().zip(left).enumerate() {
                    let Some(left) = left else { continue };
                    let off = given.sum_of_squares(&rows.joints[j], question.model.row_columns(j));
                    *floor = left.min(*floor + off / rows.joints[j].counted(0, rows.rows()));
                }
            }
            floors.push(floor);
        }
        Ok(Self { baseline, own_rows, floors, noise, noise_exceeds_all, notes })
    }
}

/// Whether noise is said to exceed by far all that was measured.
fn exceeds_all(rows: &RecordingRows, floors: &[f64]) -> bool {
    rows.role != Role::Validation
        && rows.joints.iter().zip(floors).any(|(joint, floor)| {
            let power: f64 = joint.measurement.iter().map(|m| m * m).sum();
            let counted = joint.counted(0, rows.rows());
            counted > 0.0 && *floor > INCREDIBLE * power / counted
        })
}

/// Mean square of what the baseline leaves of each joint's rows that count; `None` where there are none.
fn left(question: &Question<'_>, baseline: &Baseline, rows: &RecordingRows) -> Vec<Option<f64>> {
    let value = |column: &usize| if baseline.frozen { 0.0 } else { baseline.coefficients[*column] };
    rows.joints
        .iter()
        .enumerate()
        .map(|(j, joint)| {
            let counted = joint.counted(0, rows.rows());
            let residual = joint.residual(question.model.row_columns(j).iter().map(value));
            (counted > 0.0).then(|| residual.iter().map(|e| e * e).sum::<f64>() / counted)
        })
        .collect()
}

/// Lowers the floors of recordings, `[recording][joint]`, to what a fitted model leaves of them, and says where they
/// were too high by far.
pub(crate) fn bound_floors(
    rows: &[RecordingRows],
    layout: &Layout,
    switches: &[Switch],
    coefficients: &[f64],
    floors: &mut [Vec<f64>],
    names: RobotNames<'_>,
) -> Vec<String> {
    rows.iter()
        .zip(floors)
        .filter_map(|(recording, floors)| {
            let residual = residuals(recording, layout, switches, coefficients);
            let left: Vec<Option<f64>> = recording
                .joints
                .iter()
                .zip(&residual)
                .map(|(joint, residual)| {
                    let counted = joint.counted(0, recording.rows());
                    (counted > 0.0).then(|| residual.iter().map(|e| e * e).sum::<f64>() / counted)
                })
                .collect();
            bounded(&recording.name, floors, &left, names)
        })
        .collect()
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
