//! The noise floor: the residual that a right model would leave, from what is known of the noise.

use aurt_recording::{Preprocessed, Segment};
use aurt_traits::RobotNames;

use super::spectrum::RecordingNoise;
use crate::error::DiagnosisError;
use crate::recordings::rows::RecordingRows;

/// A floor that exceeds the residual by this factor (mean square) is wrong beyond chance.
pub(super) const CONTRADICTION: f64 = 2.0;

/// Mean square of each joint's residual that noise alone would leave in the rows that count: the noise's spectrum behind
/// the parallel filter, integrated (decimation folds it and keeps its power), of the samples that are not left out.
///
/// # Errors
/// What the filters report.
pub fn noise_floor(
    noise: &RecordingNoise,
    data: &Preprocessed,
    rows: &RecordingRows,
) -> Result<Vec<f64>, DiagnosisError> {
    (0..rows.joints.len())
        .map(|j| {
            let counts = &rows.joints[j].counts;
            let (mut sum, mut all) = (0.0, 0.0);
            let mut first = 0;
            for (segment, noise) in data.segments.iter().zip(&noise.segments) {
                let end = (first + segment.rows()).min(counts.len());
                let counted = rows.joints[j].counted(first, end);
                if counted > 0.0 {
                    sum += noise.power_left(j, segment)? * kept(segment, j, &counts[first..end])?;
                }
                all += counted;
                first = end;
            }
            Ok(sum / f64::max(all, 1.0))
        })
        .collect()
}

/// Sum over the rows that count of the share of each that comes from samples of a joint that are not left out.
fn kept(segment: &Segment, joint: usize, counts: &[bool]) -> Result<f64, DiagnosisError> {
    let Some(left_out) = &segment.left_out else {
        return Ok(counts.iter().filter(|counts| **counts).count() as f64);
    };
    let shares: Vec<f64> = left_out[joint].iter().map(|out| f64::from(u8::from(!out))).collect();
    let shares = segment.at_rows(&segment.parallel_filter.filter(&shares)?);
    Ok(shares.iter().zip(counts).filter(|(_, counts)| **counts).map(|(share, _)| share.clamp(0.0, 1.0)).sum())
}

/// Lowers floors to the mean square of what a model leaves, which noise is part of, and says of which joints they
/// were too high by far. Joints without rows keep theirs.
pub fn bounded(
    recording: &str,
    floors: &mut [f64],
    left: &[Option<f64>],
    names: RobotNames<'_>,
) -> Option<String> {
    let (mut wrong, mut said) = (Vec::new(), vec![String::new(); floors.len()]);
    for (joint, (floor, left)) in floors.iter_mut().zip(left).enumerate() {
        let Some(left) = left.filter(|left| *left < *floor) else { continue };
        if *floor > CONTRADICTION * left {
            wrong.push(joint);
            said[joint] = format!(" ({:.3} of {:.3})", floor.sqrt(), left.sqrt());
        }
        *floor = left;
    }
    (!wrong.is_empty()).then(|| {
        format!(
            "{recording}: the estimated noise floor exceeds the residual of {}; the residual is used as the noise floor \
             there, which can hide a small effect",
            names.joint_list_with(&wrong, |joint| said[joint].clone())
        )
    })
}

#[cfg(test)]
mod tests {
    use aurt_traits::RobotNames;

    use super::bounded;

    #[test]
    fn noise_is_never_more_than_what_is_left() {
        let mut floors = [1.0, 1.0, 1.0, 1.0];
        let note =
            bounded("a.csv", &mut floors, &[Some(4.0), Some(0.95), Some(0.25), None], RobotNames::default());
        assert_eq!(floors, [1.0, 0.95, 0.25, 1.0]);
        let note = note.unwrap();
        assert!(note.contains("joint 2 (1.000 of 0.500)") && !note.contains("1 ("), "{note}");
        assert_eq!(bounded("a.csv", &mut floors, &[None; 4], RobotNames::default()), None);
    }
}
