use aurt_recording::{Preprocessed, Segment, ZeroPhase};
use aurt_traits::{LoadTorque, MeasurementUnit, RobotModel};
use rayon::prelude::*;

use crate::{
    CalibrationError, JointFactor, JointRange, System, TermScopes,
    calibrated::{Calibration, CalibrationOptions, Estimator, LoadTorqueChoice, Rest},
    stream::{for_each_row_block, for_each_tile},
    system::Solution,
    uncertainty::{calibrated_parameters, noise_bandwidth_factor, warnings},
};

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
    #[must_use]
    pub fn rows(&self) -> usize {
        self.data.segments.iter().map(Segment::rows).sum()
    }
}

/// Estimates the model's coefficients from recordings: OLS for σ_j (equation 14), then WLS with weights
/// 1/σ_j² (equation 13).
///
/// With [`LoadTorqueChoice::Fitted`] this happens twice: a first fit with τ_J = 0, in which load-dependent
/// columns vanish, supplies the rigid bodies that form τ_J for the second.
///
/// # Errors
/// [`CalibrationError::TooFewSamples`] unless M > n_p, [`CalibrationError::NoMeasurement`], and what models
/// report.
pub fn calibrate(
    model: &RobotModel,
    recordings: &[NamedRecording],
    unit: MeasurementUnit,
    f_dyn_hz: f64,
    options: &CalibrationOptions,
) -> Result<Calibration, CalibrationError> {
    calibrate_scoped(model, recordings, &TermScopes::everywhere(), unit, f_dyn_hz, options)
}

/// As [`calibrate`], with arm terms that act in some of the recordings only.
///
/// # Errors
/// As [`calibrate`].
pub fn calibrate_scoped(
    model: &RobotModel,
    recordings: &[NamedRecording],
    scopes: &TermScopes,
    unit: MeasurementUnit,
    f_dyn_hz: f64,
    options: &CalibrationOptions,
) -> Result<Calibration, CalibrationError> {
    let first = recordings.first().ok_or(CalibrationError::NothingToCalibrateOn)?;
    check(model, recordings)?;
    let load = match options.load_torque {
        LoadTorqueChoice::Literal => LoadTorque::Literal,
        LoadTorqueChoice::Fitted => {
            let no_load = LoadTorque::Fitted(vec![0.0; model.parameters().len()]);
            let system = accumulate_scoped(model, recordings, scopes, &no_load, options)?;
            LoadTorque::Fitted(estimate_coefficients(&system, options.estimator)?)
        }
    };
    let system = accumulate_scoped(model, recordings, scopes, &load, options)?;
    let estimate = estimate(&system, options.estimator)?;
    let filter = first.data.segments.first().map(|s| (&s.parallel_filter, s.decimation));
    let ranges = ranges(model, recordings, &load)?;
    let names = recordings.iter().map(|r| r.name.clone()).collect();
    let setting = Setting { model, unit, f_dyn_hz, options };
    Ok(finished(&setting, &system, estimate, filter, &load, ranges, names))
}

/// What a calibration is about.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Setting<'a> {
    pub model: &'a RobotModel,
    pub unit: MeasurementUnit,
    pub f_dyn_hz: f64,
    pub options: &'a CalibrationOptions,
}

/// A calibration from its solution; `filter` is the one that rows passed, with their decimation.
pub(crate) fn finished(
    setting: &Setting<'_>,
    system: &System,
    estimate: Estimate,
    filter: Option<(&ZeroPhase, usize)>,
    load: &LoadTorque,
    ranges: Vec<JointRange>,
    recordings: Vec<String>,
) -> Calibration {
    let Setting { model, unit, f_dyn_hz, options } = *setting;
    let bandwidth = filter.map_or(1.0, |(filter, decimation)| noise_bandwidth_factor(filter, decimation));
    let parameters = calibrated_parameters(model, unit, &estimate.solution, bandwidth);
    Calibration {
        unit,
        options: *options,
        f_dyn_hz,
        warnings: warnings(&parameters),
        parameters,
        sigma: estimate.sigma,
        samples_per_joint: system.factors().iter().map(JointFactor::rows).collect(),
        condition_number: estimate.solution.condition_number,
        ranges,
        load: load.clone(),
        recordings,
        shape_fit: None,
    }
}

/// A solution with the σ_j that weighted it.
#[derive(Debug, Clone)]
pub struct Estimate {
    /// The coefficients and their covariance; for WLS the covariance of equation (13).
    pub solution: Solution,
    /// σ_j of equation (14), from the global OLS.
    pub sigma: Vec<f64>,
}

/// OLS, σ_j, and, if asked for, WLS from accumulated factors.
///
/// # Errors
/// [`CalibrationError::TooFewSamples`] unless every joint has more rows than there are parameters.
pub fn estimate(system: &System, estimator: Estimator) -> Result<Estimate, CalibrationError> {
    let (ols, excited) = system.solve_coefficients(&ones(system))?;
    let parameters = excited.iter().filter(|e| **e).count();
    let sigma = sigma(system, &ols, parameters)?;
    let mut solution = match estimator {
        Estimator::Ols => system.solve(&ones(system), |_| true)?,
        Estimator::Wls => system.solve(&weights(&sigma), |_| true)?,
    };
    if estimator == Estimator::Ols {
        let degrees: usize = system.factors().iter().map(JointFactor::rows).sum::<usize>() - parameters;
        let variance = solution.residual_sum.iter().sum::<f64>() / degrees as f64;
        solution.covariance.iter_mut().for_each(|c| *c *= variance);
    }
    Ok(Estimate { solution, sigma })
}

/// The coefficients of [`estimate`] alone.
///
/// # Errors
/// As [`estimate`].
pub(crate) fn estimate_coefficients(
    system: &System,
    estimator: Estimator,
) -> Result<Vec<f64>, CalibrationError> {
    let (ols, excited) = system.solve_coefficients(&ones(system))?;
    let sigma = sigma(system, &ols, excited.iter().filter(|e| **e).count())?;
    match estimator {
        Estimator::Ols => Ok(ols),
        Estimator::Wls => Ok(system.solve_coefficients(&weights(&sigma))?.0),
    }
}

fn ones(system: &System) -> Vec<f64> {
    vec![1.0; system.factors().len()]
}

/// σ_j of equation (14) from the global OLS.
fn sigma(system: &System, ols: &[f64], parameters: usize) -> Result<Vec<f64>, CalibrationError> {
    let rows = system.factors().iter().map(JointFactor::rows);
    rows.zip(system.residual_sum(ols))
        .map(|(rows, sum)| {
            if rows <= parameters {
                return Err(CalibrationError::TooFewSamples { rows, parameters });
            }
            Ok((sum / (rows - parameters) as f64).sqrt())
        })
        .collect()
}

/// 1/σ_j. A joint that is met exactly would get an infinite weight; the largest residual sets the scale.
pub(crate) fn weights(sigma: &[f64]) -> Vec<f64> {
    let floor = sigma.iter().fold(0.0_f64, |a, b| a.max(*b)) * 1e-12 + f64::MIN_POSITIVE.sqrt();
    sigma.iter().map(|s| 1.0 / s.max(floor)).collect()
}

/// Accumulates the factors of all joints over all recordings, segments in parallel, merged in their order (so
/// that results do not depend on the number of threads).
///
/// # Errors
/// What models report.
pub fn accumulate(
    model: &RobotModel,
    recordings: &[NamedRecording],
    load: &LoadTorque,
    options: &CalibrationOptions,
) -> Result<System, CalibrationError> {
    accumulate_scoped(model, recordings, &TermScopes::everywhere(), load, options)
}

/// As [`accumulate`], with arm terms that act in some of the recordings only.
///
/// # Errors
/// What models report.
pub fn accumulate_scoped(
    model: &RobotModel,
    recordings: &[NamedRecording],
    scopes: &TermScopes,
    load: &LoadTorque,
    options: &CalibrationOptions,
) -> Result<System, CalibrationError> {
    let segments: Vec<(&Segment, Vec<bool>)> = recordings
        .iter()
        .flat_map(|r| r.data.segments.iter().map(|s| (s, scopes.acting(model, &r.name))))
        .collect();
    let systems = segments
        .par_iter()
        .map(|(segment, acting)| accumulate_segment(model, segment, acting, load, options))
        .collect::<Result<Vec<_>, _>>()?;
    let mut systems = systems.into_iter();
    let mut total = systems.next().ok_or(CalibrationError::NothingToCalibrateOn)?;
    systems.try_for_each(|system| total.merge(&system))?;
    Ok(total)
}

fn accumulate_segment(
    model: &RobotModel,
    segment: &Segment,
    acting: &[bool],
    load: &LoadTorque,
    options: &CalibrationOptions,
) -> Result<System, CalibrationError> {
    let mut factors: Vec<JointFactor> =
        (0..model.joints()).map(|j| JointFactor::new(model.row_columns(j).to_vec())).collect();
    let absent = vec![0.0; segment.rows()];
    if let Some(measurement) = &segment.measurement {
        for_each_row_block(model, segment, load, |block| {
            for (joint, factor) in factors.iter_mut().enumerate() {
                let (slots, columns) = (model.row_slots(joint), model.row_columns(joint));
                factor.push(
                    |k| {
                        if acting[columns[k]] { block.column(slots.start + k) } else { &absent[..block.rows] }
                    },
                    block.measurement(&measurement[joint]),
                    |row| {
                        options.rest == Rest::Keep
                            || block.speed(segment, joint, row) > options.rest_velocity_rad_s
                    },
                );
            }
        })?;
    }
    Ok(System::new(model.parameters().len(), factors))
}

fn ranges(
    model: &RobotModel,
    recordings: &[NamedRecording],
    load: &LoadTorque,
) -> Result<Vec<JointRange>, CalibrationError> {
    let mut velocity = vec![0.0_f64; model.joints()];
    let mut torque = vec![0.0_f64; model.joints()];
    for segment in recordings.iter().flat_map(|r| &r.data.segments) {
        let motion = segment.motion.view();
        for (joint, largest) in velocity.iter_mut().enumerate() {
            *largest = motion.velocity_rad_s(joint).iter().fold(*largest, |a, v| a.max(v.abs()));
        }
        if matches!(load, LoadTorque::Fitted(_)) {
            for_each_tile(model, segment, load, |_, tile| {
                for (joint, largest) in torque.iter_mut().enumerate() {
                    *largest = tile.load_torque(joint).iter().fold(*largest, |a, v| a.max(v.abs()));
                }
            })?;
        }
    }
    Ok(velocity
        .into_iter()
        .zip(torque)
        .map(|(velocity_rad_s, torque)| JointRange {
            velocity_rad_s,
            load_torque: matches!(load, LoadTorque::Fitted(_)).then_some(torque),
        })
        .collect())
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
