//! Calibration and validation on recordings longer than memory.

use aurt_recording::{LongPrepared, LongSegment, Stretch};
use aurt_traits::{LoadTorque, MeasurementUnit, RobotModel, RobotState, RobotTile};

use crate::calibrate::{FittedTo, Setting, finished};
use crate::rows::{Accumulated, Folding, Measured, TILE_SAMPLES};
use crate::validation::{beyond, forget_unread};
use crate::{
    Calibration, CalibrationError, CalibrationOptions, JointMetrics, JointRange, LoadTorqueChoice, RowBlock,
    Validation, estimate, noise_bandwidth_factor, predict_tile,
};

/// As [`calibrate`](crate::calibrate), on recordings longer than memory: memory does not depend on their length, and
/// the result is that of the same recordings in memory to rounding. Models' shapes stay as they are, and deviations are
/// those of [`Deviations::White`](crate::Deviations::White).
///
/// Recordings are passed through twice with [`LoadTorqueChoice::Fitted`], else once, one after the other; joints are
/// worked on in parallel.
///
/// # Errors
/// As [`calibrate`](crate::calibrate), and [`RecordingError::Spill`](aurt_recording::RecordingError::Spill).
pub fn calibrate_long(
    model: &RobotModel,
    recordings: &[LongPrepared],
    unit: MeasurementUnit,
    f_dyn_hz: f64,
    options: &CalibrationOptions,
) -> Result<Calibration, CalibrationError> {
    let first = recordings.first().ok_or(CalibrationError::NothingToCalibrateOn)?;
    recordings.iter().try_for_each(|recording| check(model, recording))?;
    let load = match options.load_torque {
        LoadTorqueChoice::Literal => LoadTorque::Literal,
        LoadTorqueChoice::Fitted => {
            let no_load = LoadTorque::Fitted(vec![0.0; model.parameters().len()]);
            let (found, _) = accumulate_long(model, recordings, &no_load, options)?;
            LoadTorque::Fitted(estimate(&found.system, options.estimator)?.solution.coefficients)
        }
    };
    let (found, speed) = accumulate_long(model, recordings, &load, options)?;
    let estimate = estimate(&found.system, options.estimator)?;
    let is_fitted = matches!(load, LoadTorque::Fitted(_));
    let ranges = speed
        .into_iter()
        .zip(found.load_torque)
        .map(|(velocity_rad_s, torque)| JointRange {
            velocity_rad_s,
            load_torque: is_fitted.then_some(torque),
        })
        .collect();
    let names = recordings.iter().map(LongPrepared::name).collect();
    let setting = Setting { model, unit, f_dyn_hz, options };
    let bandwidth = noise_bandwidth_factor(first.parallel_filter(), first.decimation());
    let fitted_to = FittedTo { rows: None, bandwidth, ranges, names, shift: None };
    finished(&setting, &found.system, estimate, &load, fitted_to)
}

/// As [`validate`](crate::validate()) over all rows, on a recording longer than memory.
///
/// # Errors
/// As [`validate`](crate::validate()), and [`RecordingError::Spill`](aurt_recording::RecordingError::Spill).
pub fn validate_long(
    model: &RobotModel,
    calibration: &Calibration,
    recording: &LongPrepared,
) -> Result<Validation, CalibrationError> {
    check(model, recording)?;
    let joints = model.joints();
    let coefficients = calibration.coefficients();
    let rest = calibration.options.rest_velocities(&**model.rigid_body());
    let (mut all, mut moving) =
        (vec![JointMetrics::default(); joints], vec![JointMetrics::default(); joints]);
    let (mut fastest, mut heaviest) = (vec![0.0_f64; joints], vec![0.0_f64; joints]);
    let mut samples = 0;
    let mut predicted = vec![0.0; joints * TILE_SAMPLES];
    for segment in recording.segments() {
        samples += segment.rows();
        let mut rows = recording.bank(segment, joints);
        let mut delivered = 0;
        let (mut state, mut tile) = (RobotState::default(), RobotTile::default());
        let mut waiting = Waiting::new(joints);
        let mut judge = |block: &RowBlock<'_>, waiting: &Waiting| {
            for joint in 0..joints {
                let first = block.first_row - waiting.first_row;
                let measured = waiting.measurement[joint][first..].iter().zip(&waiting.speed[joint][first..]);
                for (predicted, (y, speed)) in block.column(joint).iter().zip(measured) {
                    all[joint].add(*y, *predicted);
                    if *speed > rest[joint] {
                        moving[joint].add(*y, *predicted);
                    }
                }
            }
        };
        recording.for_each_stretch::<CalibrationError>(segment, |stretch| {
            let motion = stretch.motion.view();
            widen(&mut fastest, |joint| motion.velocity_rad_s(joint));
            waiting.forget(delivered);
            waiting.add(stretch, segment);
            for first in (0..motion.samples()).step_by(TILE_SAMPLES) {
                let end = (first + TILE_SAMPLES).min(motion.samples());
                model.evaluate(motion.slice(first..end), &calibration.load, &mut state, &mut tile)?;
                widen(&mut heaviest, |joint| tile.load_torque(joint));
                predict_tile(model, &tile, &coefficients, TILE_SAMPLES, &mut predicted);
                rows.push(&predicted, TILE_SAMPLES, tile.samples(), &mut |block| {
                    delivered = block.first_row() + block.rows();
                    judge(&block.into(), &waiting);
                });
            }
            Ok(())
        })?;
        rows.finish(&mut |block| judge(&block.into(), &waiting))?;
    }
    forget_unread(model, &mut heaviest);
    Ok(Validation {
        samples,
        all: all.into_iter().collect(),
        moving: moving.into_iter().collect(),
        warnings: beyond(calibration, &fastest, &heaviest, model.names()),
    })
}

/// Refuses a recording without a measurement or of another robot.
fn check(model: &RobotModel, recording: &LongPrepared) -> Result<(), CalibrationError> {
    let file = || recording.name().into();
    if recording.joints() != model.joints() {
        let (expected, found) = (model.joints(), recording.joints());
        return Err(CalibrationError::Joints { file: file(), expected, found });
    }
    if !recording.is_measured() {
        return Err(CalibrationError::NoMeasurement { file: file() });
    }
    Ok(())
}

/// Raises each joint's value to the largest magnitude of its series.
fn widen<'a>(largest: &mut [f64], series: impl Fn(usize) -> &'a [f64]) {
    for (joint, largest) in largest.iter_mut().enumerate() {
        *largest = series(joint).iter().fold(*largest, |a, v| a.max(v.abs()));
    }
}

/// The triangles over all recordings, merged in their order, and the highest speed of each joint.
fn accumulate_long(
    model: &RobotModel,
    recordings: &[LongPrepared],
    load: &LoadTorque,
    options: &CalibrationOptions,
) -> Result<(Accumulated, Vec<f64>), CalibrationError> {
    let mut speed = vec![0.0_f64; model.joints()];
    let mut total: Option<Accumulated> = None;
    for recording in recordings {
        for segment in recording.segments() {
            let part = accumulate_segment(model, recording, segment, load, options, &mut speed)?;
            match &mut total {
                None => total = Some(part),
                Some(total) => {
                    total.system.merge(&part.system)?;
                    for (largest, other) in total.load_torque.iter_mut().zip(part.load_torque) {
                        *largest = largest.max(other);
                    }
                }
            }
        }
    }
    Ok((total.ok_or(CalibrationError::NothingToCalibrateOn)?, speed))
}

fn accumulate_segment(
    model: &RobotModel,
    recording: &LongPrepared,
    segment: &LongSegment,
    load: &LoadTorque,
    options: &CalibrationOptions,
    fastest: &mut [f64],
) -> Result<Accumulated, CalibrationError> {
    let acting = vec![true; model.parameters().len()];
    let bank = |columns| recording.bank(segment, columns);
    let mut folding = Folding::new(model, &bank, &acting, load, options);
    let mut waiting = Waiting::new(model.joints());
    recording.for_each_stretch::<CalibrationError>(segment, |stretch| {
        widen(fastest, |joint| stretch.motion.view().velocity_rad_s(joint));
        waiting.forget(folding.delivered());
        waiting.add(stretch, segment);
        waiting.with(|measured| folding.push(stretch.motion.view(), measured))
    })?;
    waiting.with(|measured| folding.finish(measured))
}

/// Measured rows that the parallel filter has not delivered yet.
struct Waiting {
    first_row: usize,
    measurement: Vec<Vec<f64>>,
    speed: Vec<Vec<f64>>,
}

impl Waiting {
    fn new(joints: usize) -> Self {
        Self { first_row: 0, measurement: vec![Vec::new(); joints], speed: vec![Vec::new(); joints] }
    }

    fn add(&mut self, stretch: &Stretch, segment: &LongSegment) {
        let motion = stretch.motion.view();
        for (joint, rows) in stretch.measurement.iter().enumerate() {
            self.measurement[joint].extend_from_slice(rows);
            let speeds = motion.velocity_rad_s(joint);
            let at = |row: usize| segment.sample(stretch.first_row + row) - stretch.first_sample;
            self.speed[joint].extend((0..rows.len()).map(|row| speeds[at(row)].abs()));
        }
    }

    /// Lets go of the rows before `row`.
    fn forget(&mut self, row: usize) {
        for series in self.measurement.iter_mut().chain(&mut self.speed) {
            series.drain(..(row - self.first_row).min(series.len()));
        }
        self.first_row = row;
    }

    fn with<T>(&self, work: impl FnOnce(&Measured<'_>) -> T) -> T {
        let speed = |joint: usize, row: usize| self.speed[joint][row];
        work(&Measured { first_row: self.first_row, measurement: &self.measurement, speed: &speed })
    }
}
