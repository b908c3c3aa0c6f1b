use aurt_traits::{ColumnGroup, RobotModel};

use super::validate::{ValidatedRows, validated};
use crate::rows::check;
use crate::{Calibration, CalibrationError, NamedRecording, for_each_predicted_block};

/// Measurement and prediction of one recording, row by row: what [`Metrics`](crate::Metrics) are means over.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Comparison {
    /// Time of each row, s, as recorded.
    pub time_s: Vec<f64>,
    /// Index of the first row of each stretch without gaps.
    pub segment_starts: Vec<usize>,
    /// The joints.
    pub joints: Vec<ComparedJoint>,
}

/// One joint's rows of a [`Comparison`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ComparedJoint {
    /// y, filtered and decimated, in the unit of the calibration.
    pub measured: Vec<f64>,
    /// ŷ, filtered and decimated alike.
    pub predicted: Vec<f64>,
    /// What of ŷ is torque of rigid bodies: the load that the joint carries.
    pub rigid_body: Vec<f64>,
    /// q, rad.
    pub position_rad: Vec<f64>,
    /// q̇, rad/s.
    pub velocity_rad_s: Vec<f64>,
    /// q̈, rad/s².
    pub acceleration_rad_s2: Vec<f64>,
}

/// Puts predictions of a calibrated model beside a recording's measurement, on the rows that
/// [`validate`](crate::validate) judges.
///
/// # Errors
/// [`CalibrationError::NoMeasurement`], and what models report.
pub fn compare(
    model: &RobotModel,
    calibration: &Calibration,
    recording: &NamedRecording,
    rows: ValidatedRows,
) -> Result<Comparison, CalibrationError> {
    check(model, std::slice::from_ref(recording))?;
    let coefficients = calibration.coefficients();
    let rigid = model.group(ColumnGroup::RigidBody);
    let rigid_coefficients: Vec<f64> =
        coefficients.iter().enumerate().map(|(k, c)| if rigid.contains(&k) { *c } else { 0.0 }).collect();
    let mut found =
        Comparison { joints: vec![ComparedJoint::default(); model.joints()], ..Comparison::default() };
    let rest = calibration.options.rest_velocities(&**model.rigid_body());
    for segment in &recording.data.segments {
        let Some(measurement) = &segment.measurement else { continue };
        let looked_at = validated(segment, rows, &rest);
        let motion = segment.motion.view();
        found.segment_starts.push(found.time_s.len());
        found.time_s.extend(looked_at.clone().map(|row| motion.time_s()[segment.sample(row)]));
        for (joint, series) in found.joints.iter_mut().enumerate() {
            series.measured.extend_from_slice(&measurement[joint][looked_at.clone()]);
            let at = |of: &[f64]| looked_at.clone().map(|row| of[segment.sample(row)]).collect::<Vec<_>>();
            series.position_rad.extend(at(motion.position_rad(joint)));
            series.velocity_rad_s.extend(at(motion.velocity_rad_s(joint)));
            series.acceleration_rad_s2.extend(at(motion.acceleration_rad_s2(joint)));
        }
        for (values, whole) in [(&coefficients, true), (&rigid_coefficients, false)] {
            for_each_predicted_block(model, segment, &calibration.load, values, |block| {
                let rows = block.first_row..block.first_row + block.rows;
                let from = looked_at.start.max(rows.start);
                let to = looked_at.end.min(rows.end);
                if from >= to {
                    return;
                }
                let part = from - rows.start..to - rows.start;
                for (joint, series) in found.joints.iter_mut().enumerate() {
                    let into = if whole { &mut series.predicted } else { &mut series.rigid_body };
                    into.extend_from_slice(&block.column(joint)[part.clone()]);
                }
            })?;
        }
    }
    Ok(found)
}
