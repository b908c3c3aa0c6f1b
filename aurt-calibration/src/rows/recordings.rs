use aurt_recording::{Preprocessed, Segment};
use aurt_traits::RobotModel;
use serde::{Deserialize, Serialize};

use crate::CalibrationError;

/// A preprocessed recording with the name under which reports mention it.
#[derive(Debug, Clone)]
pub struct NamedRecording {
    /// Name or path of the recording.
    pub name: String,
    /// Its segments.
    pub data: Preprocessed,
}

impl NamedRecording {
    /// Rows per joint over all segments.
    pub fn rows(&self) -> usize {
        self.data.segments.iter().map(Segment::rows).sum()
    }

    /// Whether another recording holds the same motion and measurement, whatever its name.
    pub fn is_copy_of(&self, other: &Self) -> bool {
        let (own, others) = (&self.data.segments, &other.data.segments);
        own.len() == others.len()
            && own.iter().zip(others).all(|(a, b)| {
                let (x, y) = (a.motion.view(), b.motion.view());
                a.measurement == b.measurement
                    && x.joints() == y.joints()
                    && (0..x.joints()).all(|j| x.position_rad(j) == y.position_rad(j))
            })
    }
}

/// The range that a joint covered in calibration; predictions beyond it are extrapolations.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct JointRange {
    /// Largest |q̇|, rad/s.
    pub velocity_rad_s: f64,
    /// Largest |τ_J| in the unit of the measurement; absent for the literal load torque, which has no unit.
    pub load_torque: Option<f64>,
}

/// What joints did; `load_torque` is the largest |τ_J| of each.
pub(crate) fn ranges(
    recordings: &[NamedRecording],
    load_torque: Option<&[f64]>,
    joints: usize,
) -> Vec<JointRange> {
    let fastest = |joint: usize| {
        let segments = recordings.iter().flat_map(|r| &r.data.segments);
        let speeds = segments.flat_map(|s| s.motion.view().velocity_rad_s(joint));
        speeds.fold(0.0_f64, |a, v| a.max(v.abs()))
    };
    (0..joints)
        .map(|joint| JointRange {
            velocity_rad_s: fastest(joint),
            load_torque: load_torque.map(|largest| largest[joint]),
        })
        .collect()
}

/// Refuses recordings without a measurement or of another robot.
pub(crate) fn check(model: &RobotModel, recordings: &[NamedRecording]) -> Result<(), CalibrationError> {
    for recording in recordings {
        for segment in &recording.data.segments {
            if segment.motion.joints() != model.joints() {
                return Err(CalibrationError::Joints {
                    file: recording.name.clone().into(),
                    expected: model.joints(),
                    found: segment.motion.joints(),
                });
            }
            if segment.measurement.is_none() {
                return Err(CalibrationError::NoMeasurement { file: recording.name.clone().into() });
            }
        }
    }
    Ok(())
}
