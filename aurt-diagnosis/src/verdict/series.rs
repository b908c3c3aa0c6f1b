//! Residuals row by row, before and after what was found: what the figures of a verdict are means over.

use crate::error::DiagnosisError;
use crate::evidence::baseline::weighted_fit;
use crate::evidence::residuals::residuals;
use crate::investigation::Investigation;
use crate::recordings::rows::{RecordingRows, Role};
use crate::request::{Question, QuestionedRecording};
use crate::verdict::localise;
use crate::verdict::write::rigid_body_load;

/// One recording of an investigation, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordingSeries {
    pub name: String,
    /// Its part.
    pub role: Role,
    /// First held-out row; the number of rows where there are none.
    pub held_out_from: usize,
    /// Time of each row since the recording's first stamp, s.
    pub time_s: Vec<f64>,
    /// Index of the first row of each stretch without gaps.
    pub segment_starts: Vec<usize>,
    pub joints: Vec<JointSeriesRows>,
}

/// One joint of a [`RecordingSeries`]. Rows that do not count (the joint stands or reverses, the recording is faulty, something
/// touched the arm) are not a number in the residuals.
#[derive(Debug, Clone, PartialEq)]
pub struct JointSeriesRows {
    /// The measurement; absent where a given model or simulator was subtracted and the rows cannot be matched.
    pub measured: Option<Vec<f64>>,
    /// Residual of the model in question: on fitted rows as fitted to all of them, as `baseline_rms`; on held-out rows
    /// as calibrated without the targets (or as given), as `rms_before`.
    pub before: Vec<f64>,
    /// Residual of the model with what was found.
    pub after: Vec<f64>,
    /// Root mean square that noise alone leaves.
    pub floor_rms: f64,
    /// Windows in which `after` stands out, s since the recording's first stamp.
    pub windows_s: Vec<[f64; 2]>,
    /// q, rad.
    pub position_rad: Vec<f64>,
    /// q̇, rad/s.
    pub velocity_rad_s: Vec<f64>,
    /// q̈, rad/s².
    pub acceleration_rad_s2: Vec<f64>,
    /// Rigid-body torque of the baseline, in the measurement's unit.
    pub load_torque: Vec<f64>,
}

/// The rows behind a verdict.
pub fn series(question: &Question<'_>, investigation: &Investigation) -> Vec<RecordingSeries> {
    let all = investigation.switches();
    let fit = |switches| weighted_fit(&investigation.problem, switches, &investigation.floor).0.coefficients;
    let full = fit(&all);
    let layout = &investigation.layout;
    // Before is before a delay was undone, too.
    let first = investigation.late.as_ref().map_or(investigation, |late| &late.before);
    let base = weighted_fit(&first.problem, &first.base_switches, &first.floor).0.coefficients;
    let examined = examined(question, investigation).unwrap_or_default();
    let whole = |of: &Investigation, r: usize| of.rows[r].followed_by(&of.confirm.to_judge()[r]);
    (0..investigation.rows.len())
        .map(|r| {
            let rows = &whole(investigation, r);
            let then = &whole(first, r);
            let before = if then.rows() == rows.rows() { then } else { rows };
            let left =
                |coefficients: &[f64]| residuals(before, &first.layout, &first.base_switches, coefficients);
            let (fitted, calibrated) = (left(&base), left(&first.baseline.coefficients));
            let after = residuals(rows, layout, &all, &full);
            let held_out_from = investigation.rows[r].rows();
            let origin_s = question.recordings[r].origin_s();
            let measured = examined.get(r).and_then(|recording| measured(recording, rows));
            let joints = (0..rows.joints.len())
                .map(|j| {
                    let joint = &rows.joints[j];
                    let counted = |(k, value): (usize, f64)| if joint.counts[k] { value } else { f64::NAN };
                    let before = fitted[j][..held_out_from].iter().chain(&calibrated[j][held_out_from..]);
                    let floor_rms = investigation.floors[r][j].sqrt();
                    let shift = rows.time_s.first().map_or(0.0, |t| t - origin_s);
                    JointSeriesRows {
                        measured: measured.as_ref().map(|m| m[j].clone()),
                        before: before.copied().enumerate().map(counted).collect(),
                        after: after[j].iter().copied().enumerate().map(counted).collect(),
                        floor_rms,
                        windows_s: localise::windows(rows, j, &after[j], investigation.floor[j].sqrt())
                            .into_iter()
                            .map(|w| w.map(|t| t + shift))
                            .collect(),
                        position_rad: joint.position_rad.clone(),
                        velocity_rad_s: joint.velocity_rad_s.clone(),
                        acceleration_rad_s2: joint.acceleration_rad_s2.clone(),
                        load_torque: rigid_body_load(investigation, rows, j),
                    }
                })
                .collect();
            RecordingSeries {
                name: rows.name.clone(),
                role: rows.role,
                held_out_from,
                time_s: rows.time_s.iter().map(|t| t - origin_s).collect(),
                segment_starts: rows.segment_starts[..rows.segment_starts.len().saturating_sub(1)].to_vec(),
                joints,
            }
        })
        .collect()
}

/// The recordings as their rows were made: with a delay undone and faults repaired.
fn examined(
    question: &Question<'_>,
    investigation: &Investigation,
) -> Result<Vec<QuestionedRecording>, DiagnosisError> {
    let late = investigation.late.as_ref();
    let recordings = match late {
        Some(late) => late.delay.undone(question)?,
        None => question.recordings.to_vec(),
    };
    recordings.iter().map(|recording| recording.repaired(question.without)).collect()
}

/// The measurement of every row, from the recording as it was preprocessed: rows of an investigation are silent where
/// they do not count, and less the prediction where a model is taken as given.
fn measured(recording: &QuestionedRecording, rows: &RecordingRows) -> Option<Vec<Vec<f64>>> {
    let mut segments = recording.data.data.segments.clone();
    for segment in segments.iter_mut().filter(|s| s.left_out.is_some()) {
        segment.leave_out(None).ok()?;
    }
    let joints = (0..rows.joints.len())
        .map(|j| {
            let of_joint =
                |s: &aurt_recording::Segment| Some(s.measurement.as_ref()?[j][..s.rows()].to_vec());
            Some(segments.iter().map(of_joint).collect::<Option<Vec<_>>>()?.concat())
        })
        .collect::<Option<Vec<Vec<f64>>>>()?;
    joints.iter().all(|j| j.len() == rows.rows()).then_some(joints)
}
