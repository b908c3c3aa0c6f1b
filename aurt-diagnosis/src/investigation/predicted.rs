//! Whether the measurement has to do with the motion at all.

use aurt_recording::Segment;

use crate::evidence::baseline::{Baseline, own_switches, weighted_fit};
use crate::evidence::gram::BlockMoments;
use crate::evidence::problem::Problem;
use crate::recordings::divided::FitRows;
use crate::recordings::partition::Partition;
use crate::recordings::rows::{Layout, RecordingRows};
use crate::request::{Question, QuestionedRecording};

/// Share of the measurement's variance that the model in question predicts on time that it was not fitted to, joint by
/// joint; none for a joint without rows. The variance is about each recording's mean.
pub(super) fn shares(
    question: &Question<'_>,
    baseline: &Baseline,
    rows: &FitRows,
    partition: &Partition,
) -> Vec<Option<f64>> {
    let joints = question.model.joints();
    let mut variance = vec![0.0; joints];
    let mut counted = vec![0.0; joints];
    for (recording, rows) in question.recordings.iter().zip(rows.iter()) {
        for (j, (variance, counted)) in variance.iter_mut().zip(&mut counted).enumerate() {
            let values = measured(recording, rows, j);
            let count = values.len() as f64;
            let mean = values.iter().sum::<f64>() / count.max(1.0);
            *variance += values.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
            *counted += count;
        }
    }
    let problem = Problem::new(&Layout::new(question.model), BlockMoments::accumulate(rows, partition));
    let own = if baseline.frozen { Vec::new() } else { own_switches(question.model) };
    let (_, weights) = weighted_fit(&problem, &own, &[]);
    let errors = problem.held_out(&problem.nest(&own, &weights), &[]);
    (0..joints)
        .map(|j| {
            let judged = problem.rows(j, false);
            let whole = variance[j] / f64::max(counted[j], 1.0);
            let left = (errors[0][j] + errors[1][j]) / judged.max(1.0);
            (judged > 0.0 && whole > 0.0).then(|| 1.0 - left / whole)
        })
        .collect()
}

/// The measurement of a joint at the rows that count, as it was preprocessed: rows may be less a given model's.
fn measured(recording: &QuestionedRecording, rows: &RecordingRows, joint: usize) -> Vec<f64> {
    let segments = &recording.data.data.segments;
    let series = segments.iter().filter_map(|s: &Segment| Some(&s.measurement.as_ref()?[joint][..s.rows()]));
    let counts = &rows.joints[joint].counts;
    series.flatten().zip(counts).filter(|(_, counts)| **counts).map(|(value, _)| *value).collect()
}
