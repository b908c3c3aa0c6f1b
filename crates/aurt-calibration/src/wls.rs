use aurt_recording::{Preprocessed, Segment};
use aurt_traits::{LoadTorque, MeasurementUnit, RobotModel};

use crate::{
    CalibrationError, JointFactor, JointRange, System, TermScopes,
    accumulate::{Accumulated, accumulate_ranged, accumulate_scoped},
    calibrated::{Calibration, CalibrationOptions, Estimator, LoadTorqueChoice},
    excitation::warnings,
    physical,
    system::Solution,
    uncertainty::{calibrated_parameters, noise_bandwidth_factor},
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
    let Accumulated { system, load_torque } = accumulate_ranged(model, recordings, scopes, &load, options)?;
    let estimate = estimate(&system, options.estimator)?;
    let bandwidth =
        first.data.segments.first().map_or(1.0, |s| noise_bandwidth_factor(&s.parallel_filter, s.decimation));
    let load_torque = matches!(load, LoadTorque::Fitted(_)).then_some(load_torque);
    let ranges = ranges(recordings, load_torque.as_deref(), model.joints());
    let names = recordings.iter().map(|r| r.name.clone()).collect();
    let setting = Setting { model, unit, f_dyn_hz, options };
    Ok(finished(&setting, &system, estimate, bandwidth, &load, ranges, names))
}

/// What a calibration is about.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Setting<'a> {
    pub model: &'a RobotModel,
    pub unit: MeasurementUnit,
    pub f_dyn_hz: f64,
    pub options: &'a CalibrationOptions,
}

/// A calibration from its solution; `bandwidth` is the [`noise_bandwidth_factor`] of the filter that rows passed.
pub(crate) fn finished(
    setting: &Setting<'_>,
    system: &System,
    estimate: Estimate,
    bandwidth: f64,
    load: &LoadTorque,
    ranges: Vec<JointRange>,
    recordings: Vec<String>,
) -> Calibration {
    let Setting { model, unit, f_dyn_hz, options } = *setting;
    let parameters = calibrated_parameters(model, unit, &estimate.solution, bandwidth);
    let mut warnings = warnings(&parameters, estimate.solution.condition_number);
    warnings.extend(physical::warnings(&physical::Fitted {
        model,
        parameters: &parameters,
        covariance: &estimate.solution.covariance,
        bandwidth,
        ranges: &ranges,
        options,
        unit_of_measurement: unit,
    }));
    Calibration {
        unit,
        options: *options,
        f_dyn_hz,
        warnings,
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

fn ranges(recordings: &[NamedRecording], load_torque: Option<&[f64]>, joints: usize) -> Vec<JointRange> {
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
