use std::ops::Range;

use aurt_recording::Segment;
use aurt_traits::{RobotModel, RobotNames};
use serde::{Deserialize, Serialize};

use super::metrics::{JointMetrics, Metrics};
use crate::rows::check;
use crate::{
    Calibration, CalibrationError, NamedRecording, for_each_predicted_block, for_each_tile, predict_tile,
};

/// How a calibrated model does on one recording, on the filtered and decimated measurement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Validation {
    /// Rows per joint.
    pub samples: usize,
    /// Over all rows.
    pub all: Metrics,
    /// Over the rows at which the joint moves (|q̇_j| above the rest velocity).
    pub moving: Metrics,
    /// Where the recording leaves what calibration covered.
    pub warnings: Vec<String>,
}

/// Which rows of a recording a validation looks at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ValidatedRows {
    /// Those between the first and the last at which any joint moves: standing before and after a motion says
    /// nothing of a model, since the sign of a resting joint's velocity is that of rounding noise.
    #[default]
    WhileInMotion,
    /// All (the paper's tool).
    All,
}

pub(crate) fn validated(segment: &Segment, rows: ValidatedRows, rest: &[f64]) -> Range<usize> {
    let all = 0..segment.rows();
    if rows == ValidatedRows::All {
        return all;
    }
    let motion = segment.motion.view();
    let moves = |row: &usize| {
        (0..motion.joints()).any(|j| motion.velocity_rad_s(j)[segment.sample(*row)].abs() > rest[j])
    };
    match (all.clone().find(moves), all.clone().rfind(moves)) {
        (Some(first), Some(last)) => first..last + 1,
        _ => all,
    }
}

/// Compares predictions of a calibrated model with a recording's measurement.
///
/// # Errors
/// [`CalibrationError::NoMeasurement`], and what models report.
pub fn validate(
    model: &RobotModel,
    calibration: &Calibration,
    recording: &NamedRecording,
    rows: ValidatedRows,
) -> Result<Validation, CalibrationError> {
    check(model, std::slice::from_ref(recording))?;
    let coefficients = calibration.coefficients();
    let mut all = vec![JointMetrics::default(); model.joints()];
    let mut moving = all.clone();
    let mut samples = 0;
    let rest = calibration.options.rest_velocities(&**model.rigid_body());
    for segment in &recording.data.segments {
        let Some(measurement) = &segment.measurement else { continue };
        let looked_at = validated(segment, rows, &rest);
        samples += looked_at.len();
        for_each_predicted_block(model, segment, &calibration.load, &coefficients, |block| {
            for joint in 0..model.joints() {
                let measured = block.measurement(&measurement[joint]);
                for (row, (y, predicted)) in measured.iter().zip(block.column(joint)).enumerate() {
                    if !looked_at.contains(&(block.first_row + row)) {
                        continue;
                    }
                    all[joint].add(*y, *predicted);
                    if block.speed(segment, joint, row) > rest[joint] {
                        moving[joint].add(*y, *predicted);
                    }
                }
            }
        })?;
    }
    Ok(Validation {
        samples,
        all: all.into_iter().collect(),
        moving: moving.into_iter().collect(),
        warnings: extrapolations(model, calibration, recording)?,
    })
}

/// A prediction over the grid of a recording's segment, unfiltered.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// Times of the grid, s.
    pub time_s: Vec<f64>,
    /// ŷ of each joint.
    pub predicted: Vec<Vec<f64>>,
}

/// Predicts the measurement over every segment of a recording; no measurement is needed.
///
/// # Errors
/// [`CalibrationError::Joints`], and what models report.
pub fn predict(
    model: &RobotModel,
    calibration: &Calibration,
    recording: &NamedRecording,
) -> Result<Vec<Prediction>, CalibrationError> {
    let coefficients = calibration.coefficients();
    recording
        .data
        .segments
        .iter()
        .map(|segment| {
            let samples = segment.motion.samples();
            let mut predicted = vec![vec![0.0; samples]; model.joints()];
            let mut scratch = Vec::new();
            for_each_tile(model, segment, &calibration.load, |first, tile| {
                let n = tile.samples();
                scratch.resize(model.joints() * n, 0.0);
                predict_tile(model, tile, &coefficients, n, &mut scratch);
                for (series, joint) in predicted.iter_mut().zip(scratch.chunks_exact(n)) {
                    series[first..first + n].copy_from_slice(joint);
                }
            })?;
            Ok(Prediction { time_s: segment.motion.view().time_s().to_vec(), predicted })
        })
        .collect()
}

/// A little beyond the covered range is no extrapolation worth a warning.
const RANGE_MARGIN: f64 = 1.05;
/// A joint that is never faster stands, rad/s.
const REST_RAD_S: f64 = 0.01;

/// Warnings for joints that move faster or carry more than in calibration.
///
/// # Errors
/// What models report.
pub fn extrapolations(
    model: &RobotModel,
    calibration: &Calibration,
    recording: &NamedRecording,
) -> Result<Vec<String>, CalibrationError> {
    let mut load = vec![0.0_f64; model.joints()];
    let mut velocity = vec![0.0_f64; model.joints()];
    for segment in &recording.data.segments {
        for (joint, largest) in velocity.iter_mut().enumerate() {
            *largest =
                segment.motion.view().velocity_rad_s(joint).iter().fold(*largest, |a, v| a.max(v.abs()));
        }
        for_each_tile(model, segment, &calibration.load, |_, tile| {
            for (joint, largest) in load.iter_mut().enumerate() {
                *largest = tile.load_torque(joint).iter().fold(*largest, |a, v| a.max(v.abs()));
            }
        })?;
    }
    forget_unread(model, &mut load);
    Ok(beyond(calibration, &velocity, &load, model.names()))
}

/// Takes the loads of joints whose friction does not depend on them for none: nothing is extrapolated there.
pub(crate) fn forget_unread(model: &RobotModel, load: &mut [f64]) {
    for (load, stack) in load.iter_mut().zip(model.stacks()) {
        let reads =
            stack.coulomb().reads_load() || stack.hysteresis().reads_load() || stack.viscous().reads_load();
        if !reads {
            *load = 0.0;
        }
    }
}

/// Warnings for joints whose largest speeds, rad/s, and load torques lie beyond what calibration covered.
pub(crate) fn beyond(
    calibration: &Calibration,
    velocity: &[f64],
    load: &[f64],
    names: RobotNames<'_>,
) -> Vec<String> {
    let mut warnings = Vec::new();
    for (joint, range) in calibration.ranges.iter().enumerate() {
        let named = names.joint(joint);
        // A joint that stands shows the noise of its sensor, and a ratio of two of these says nothing.
        if velocity[joint] > REST_RAD_S && range.velocity_rad_s <= REST_RAD_S {
            warnings.push(format!(
                "{named} moves at up to {:.2} rad/s but stood still in calibration: its friction is unknown",
                velocity[joint]
            ));
        } else if velocity[joint] > (RANGE_MARGIN * range.velocity_rad_s).max(REST_RAD_S) {
            warnings.push(format!(
                "{named} moves at up to {:.2} rad/s, {:.1} times the {:.2} rad/s that calibration \
                 covered: its friction is extrapolated",
                velocity[joint],
                velocity[joint] / range.velocity_rad_s,
                range.velocity_rad_s
            ));
        }
        if let Some(covered) = range.load_torque.filter(|t| load[joint] > RANGE_MARGIN * t) {
            warnings.push(format!(
                "{named} carries up to {:.3} {unit}, calibration covered {covered:.3} {unit}: its \
                 load-dependent friction is extrapolated",
                load[joint],
                unit = calibration.unit.symbol()
            ));
        }
    }
    warnings
}
