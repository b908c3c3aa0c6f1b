use aurt_recording::{Preprocessed, Segment};
use aurt_traits::{LoadTorque, MeasurementUnit, RobotModel};

use crate::{
    CalibratedParameter, CalibrationError, ConsistentReport, EssentialReport, Fit, JointFactor, JointRange,
    PositionBias, RobustReport, System, TermScopes,
    accumulate::{Accumulated, accumulate_ranged, accumulate_scoped},
    calibrated::{Calibration, CalibrationOptions, Deviations, Estimator, LoadTorqueChoice},
    consistent::{Prior, make_consistent},
    deviations::{Observed, sandwich},
    errors_in_positions::{Fitted, Looked, Shift, Tested, look},
    essential::{Full, Listed, eliminate},
    excitation::warnings,
    physical,
    robust::{Rows, reweight},
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

    /// Whether another recording holds the same motion and measurement, whatever its name.
    #[must_use]
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
    let recordings: Vec<&NamedRecording> = recordings.iter().collect();
    let fitted_to =
        FittedTo { recordings: Some((&recordings, scopes)), bandwidth, ranges, names, shift: None };
    finished(&setting, &system, estimate, &load, fitted_to)
}

/// What a calibration is about.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Setting<'a> {
    pub model: &'a RobotModel,
    pub unit: MeasurementUnit,
    pub f_dyn_hz: f64,
    pub options: &'a CalibrationOptions,
}

/// What a solution was fitted to.
pub(crate) struct FittedTo<'a> {
    /// The recordings and in which of them each arm term acts, where they are at hand to be looked at again.
    pub recordings: Option<(&'a [&'a NamedRecording], &'a TermScopes)>,
    /// The [`noise_bandwidth_factor`] of the filter that rows passed.
    pub bandwidth: f64,
    /// What joints did.
    pub ranges: Vec<JointRange>,
    /// The recordings' names.
    pub names: Vec<String>,
    /// What noise of the positions does to the fit, where that is known already.
    pub shift: Option<&'a Shift>,
}

/// A calibration from its solution.
///
/// # Errors
/// What models report, and [`make_consistent`].
pub(crate) fn finished(
    setting: &Setting<'_>,
    system: &System,
    mut estimate: Estimate,
    load: &LoadTorque,
    fitted_to: FittedTo<'_>,
) -> Result<Calibration, CalibrationError> {
    let Setting { model, unit, f_dyn_hz, options } = *setting;
    let FittedTo { recordings, mut bandwidth, ranges, names, shift } = fitted_to;
    let mut essential = None;
    if options.estimator == Estimator::Essential {
        let (recordings, scopes) =
            recordings.ok_or(CalibrationError::NeedsRows { estimator: "essential" })?;
        let weights = weights(&estimate.sigma);
        let full = Full { model, options, load, system, weights: &weights };
        let listed: Vec<Listed<'_>> = recordings
            .iter()
            .map(|recording| Listed { recording, acting: scopes.acting(model, &recording.name) })
            .collect();
        let (kept, report) = eliminate(&full, &listed)?;
        estimate.solution = system.solve(&weights, |k| kept[k])?;
        essential = Some(report);
    }
    let looked = position_noise(setting, system, &estimate, load, recordings, shift)?;
    let mut bread = None;
    if let Some((coefficients, inverse)) = looked.as_ref().and_then(|looked| looked.corrected.as_ref()) {
        estimate.solution.coefficients.clone_from(coefficients);
        estimate.solution.covariance.clone_from(inverse);
        bread = Some(inverse.as_slice());
    }
    let instrumental;
    if options.estimator == Estimator::Iv {
        let (recordings, scopes) = recordings.ok_or(CalibrationError::NeedsRows { estimator: "iv" })?;
        let weights = weights(&estimate.sigma);
        let coefficients = &estimate.solution.coefficients;
        let tested = Tested { model, recordings, scopes, load, options, coefficients, weights: &weights };
        if let Some((coefficients, own)) = tested.instrumental()? {
            estimate.solution.coefficients = coefficients;
            estimate.solution.covariance.clone_from(&own);
            instrumental = own;
            bread = Some(instrumental.as_slice());
        }
    }
    let mut robust = None;
    if options.estimator == Estimator::Irls {
        let (recordings, scopes) = recordings.ok_or(CalibrationError::NeedsRows { estimator: "irls" })?;
        let observed = Rows { model, recordings, scopes, load, options };
        let reweighted = reweight(&observed, system, &estimate)?;
        estimate.solution.coefficients = reweighted.coefficients;
        estimate.solution.covariance = reweighted.covariance;
        estimate.sigma = reweighted.sigma;
        robust = Some((reweighted.report, reweighted.bread));
    }
    let bread = robust.as_ref().map(|(_, bread)| bread.as_slice()).or(bread);
    if let Some((recordings, scopes)) = recordings.filter(|_| options.deviations == Deviations::Memory) {
        let observed = (recordings, scopes, load);
        remember(setting, system, &mut estimate, (bandwidth, bread), observed)?;
        bandwidth = 1.0;
    }
    let n = estimate.solution.coefficients.len();
    let deviation = |k: usize| (bandwidth * estimate.solution.covariance[k * n + k]).sqrt();
    let position_bias = looked.as_ref().map(|looked| PositionBias::of(model, looked, deviation));
    let mut consistent = None;
    if options.estimator == Estimator::Consistent {
        let scale = bandwidth * noise_scale(system, &estimate)?;
        let (coefficients, report) = make_consistent(
            &Fit {
                model,
                system,
                weights: &weights(&estimate.sigma),
                coefficients: &estimate.solution.coefficients,
                covariance: &estimate.solution.covariance,
                scale,
                ranges: &ranges,
                options,
            },
            Prior::of(model, unit)?.as_ref(),
        )?;
        estimate.solution.coefficients = coefficients;
        consistent = Some(report);
    }
    let robust = robust.map(|(report, _)| report);
    // Motions are not to blame for noise of the positions.
    let judged = calibrated_parameters(model, unit, &estimate.solution, bandwidth);
    // What was taken off is no error any more.
    let biased = looked.as_ref().filter(|looked| looked.corrected.is_none());
    if let Some(looked) = biased {
        looked.shift.widen(&mut estimate.solution.covariance);
    }
    let parameters = calibrated_parameters(model, unit, &estimate.solution, bandwidth);
    let is_eliminated =
        |name: &str| essential.iter().any(|report: &EssentialReport| report.eliminated().any(|e| e == name));
    let judged: Vec<CalibratedParameter> = judged.into_iter().filter(|p| !is_eliminated(&p.name)).collect();
    let mut warnings = warnings(&judged, estimate.solution.condition_number);
    warnings.extend(consistent.iter().flat_map(ConsistentReport::warnings));
    warnings.extend(position_bias.iter().filter_map(PositionBias::overwhelming));
    warnings.extend(position_bias.iter().filter(|_| biased.is_some()).filter_map(PositionBias::warning));
    warnings.extend(robust.iter().flat_map(RobustReport::warnings));
    warnings.extend(physical::warnings(&physical::Fitted {
        model,
        parameters: &parameters,
        covariance: &estimate.solution.covariance,
        bandwidth,
        ranges: &ranges,
        options,
        unit_of_measurement: unit,
    }));
    Ok(Calibration {
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
        recordings: names,
        shape_fit: None,
        consistent,
        essential,
        position_bias,
        robust,
    })
}

/// What noise of the positions does, where there are rows to be looked at again; `shift` is known where shapes were searched, since
/// coefficients are shifted otherwise with these to be found.
///
/// # Errors
/// [`CalibrationError::NeedsRows`] and [`CalibrationError::NoisyPositions`] if the estimator cannot do without; what models
/// report.
fn position_noise(
    setting: &Setting<'_>,
    system: &System,
    estimate: &Estimate,
    load: &LoadTorque,
    recordings: Option<(&[&NamedRecording], &TermScopes)>,
    shift: Option<&Shift>,
) -> Result<Option<Looked>, CalibrationError> {
    let Setting { model, options, .. } = *setting;
    let is_used = options.estimator == Estimator::Eiv;
    let Some((recordings, scopes)) = recordings else {
        return if is_used { Err(CalibrationError::NeedsRows { estimator: "eiv" }) } else { Ok(None) };
    };
    if !is_used && !options.tells_position_bias() {
        return Ok(None);
    }
    let weights = if options.estimator.is_weighted() { weights(&estimate.sigma) } else { ones(system) };
    let solution = &estimate.solution;
    let fitted = Fitted { model, options, load, scopes, recordings, system, weights: &weights, solution };
    look(&fitted, is_used, shift).map(Some)
}

/// Puts the covariance of noise with a memory in the place of that of independent rows.
fn remember(
    setting: &Setting<'_>,
    system: &System,
    estimate: &mut Estimate,
    (bandwidth, bread): (f64, Option<&[f64]>),
    (recordings, scopes, load): (&[&NamedRecording], &TermScopes, &LoadTorque),
) -> Result<(), CalibrationError> {
    let Setting { model, options, .. } = *setting;
    let weights = if options.estimator.is_weighted() { weights(&estimate.sigma) } else { ones(system) };
    let excited = estimate.solution.excited.clone();
    // What was eliminated is not fitted.
    let is_fitted = |k: usize| options.estimator != Estimator::Essential || excited[k];
    let mut plain = system.solve(&weights, is_fitted)?;
    if let Some(bread) = bread {
        plain.covariance.copy_from_slice(bread);
    }
    let covariance = sandwich(&Observed {
        model,
        recordings,
        scopes,
        load,
        options,
        coefficients: &estimate.solution.coefficients,
        weights: &weights,
        bread: &plain.covariance,
        sigma: (options.estimator == Estimator::Irls).then_some(estimate.sigma.as_slice()),
        instruments: options.estimator == Estimator::Iv,
        lift: None,
    })?;
    let n = plain.coefficients.len();
    // Where shapes were searched, the coefficients are surer than they look with these known: that factor stays.
    let unit = if options.estimator.is_weighted() { 1.0 } else { variance(system, &plain) };
    let factor: Vec<f64> = (0..n)
        .map(|k| {
            let at = k * n + k;
            let (more, own) = (estimate.solution.covariance[at], unit * plain.covariance[at]);
            let known = if own > 0.0 { more / own } else { 1.0 };
            // Weights by row have a bread that is no covariance, and theirs of white noise holds what shapes add.
            let (known, own) = if options.estimator == Estimator::Irls { (1.0, more) } else { (known, own) };
            // Noise that seems to hide from the fit is not believed: white noise is the least.
            let least = bandwidth * own;
            let surer = if covariance[at] > 0.0 { (least / covariance[at]).max(1.0) } else { 1.0 };
            (known.max(1.0) * surer).sqrt()
        })
        .collect();
    for c in 0..n {
        for r in 0..n {
            estimate.solution.covariance[c * n + r] = covariance[c * n + r] * factor[r] * factor[c];
        }
    }
    Ok(())
}

/// Mean squared residual of an unweighted fit.
fn variance(system: &System, solution: &Solution) -> f64 {
    let parameters = solution.excited.iter().filter(|e| **e).count();
    let rows = system.factors().iter().map(JointFactor::rows).sum::<usize>();
    solution.residual_sum.iter().sum::<f64>() / rows.saturating_sub(parameters).max(1) as f64
}

/// By how much the variance of the coefficients, in the mean, exceeds that of independent rows.
fn noise_scale(system: &System, estimate: &Estimate) -> Result<f64, CalibrationError> {
    let plain = system.solve(&weights(&estimate.sigma), |_| true)?.covariance;
    let n = estimate.solution.coefficients.len();
    let ratios: Vec<f64> = (0..n)
        .map(|k| estimate.solution.covariance[k * n + k] / plain[k * n + k])
        .filter(|r| r.is_finite() && *r > 0.0)
        .collect();
    Ok(if ratios.is_empty() { 1.0 } else { ratios.iter().sum::<f64>() / ratios.len() as f64 })
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
    let weights = if estimator.is_weighted() { weights(&sigma) } else { ones(system) };
    let mut solution = system.solve(&weights, |_| true)?;
    if estimator == Estimator::Ols {
        let variance = variance(system, &solution);
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
    if estimator.is_weighted() { Ok(system.solve_coefficients(&weights(&sigma))?.0) } else { Ok(ols) }
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
