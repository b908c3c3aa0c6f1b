use aurt_traits::{LoadTorque, MeasurementUnit, RobotModel};

use crate::consistent::{Prior, make_consistent};
use crate::deviations::Sandwich;
use crate::errors_in_positions::{Fitted, Looked, Shift, look};
use crate::essential::{Full, eliminate};
use crate::excitation::{at_rest, warnings};
use crate::robust::{Loss, reweight};
use crate::rows::{Accumulated, Observed, accumulate_ranged, check, ranges};
use crate::separability::Dependence;
use crate::system::{estimate_coefficients, noise_scale, ones, variance, weights};
use crate::uncertainty::{calibrated_parameters, covariance, noise_bandwidth_factor};
use crate::{
    CalibratedParameter, Calibration, CalibrationError, CalibrationOptions, Deviations, EssentialReport,
    Estimate, Estimator, Fit, JointFactor, JointRange, LoadTorqueChoice, NamedRecording, PositionBias,
    System, TermScopes, accumulate, estimate, physical,
};

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
            let system = accumulate(model, recordings, scopes, &no_load, options)?;
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
    let rows = Observed { model, recordings: &recordings, scopes, load: &load, options };
    let fitted_to = FittedTo { rows: Some(rows), bandwidth, ranges, names, shift: None };
    finished(&setting, &system, estimate, &load, fitted_to)
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct Setting<'a> {
    pub model: &'a RobotModel,
    pub unit: MeasurementUnit,
    pub f_dyn_hz: f64,
    pub options: &'a CalibrationOptions,
}

pub(crate) struct FittedTo<'a> {
    /// The recordings, where they are available to be looked at again.
    pub rows: Option<Observed<'a>>,
    /// The [`noise_bandwidth_factor`] of the filter that rows passed.
    pub bandwidth: f64,
    /// What joints did.
    pub ranges: Vec<JointRange>,
    /// The recordings' names.
    pub names: Vec<String>,
    /// What noise of the positions does to the fit, where that is known already.
    pub shift: Option<&'a Shift>,
}

pub(crate) fn finished(
    setting: &Setting<'_>,
    system: &System,
    mut estimate: Estimate,
    load: &LoadTorque,
    fitted_to: FittedTo<'_>,
) -> Result<Calibration, CalibrationError> {
    let Setting { model, unit, f_dyn_hz, options } = *setting;
    let FittedTo { rows, mut bandwidth, ranges, names, shift } = fitted_to;
    let needed = |estimator| rows.ok_or(CalibrationError::NeedsRows { estimator });
    let mut essential = None;
    if options.estimator == Estimator::Essential {
        let weights = weights(&estimate.sigma);
        let (kept, report) = eliminate(&Full { rows: needed("essential")?, system, weights: &weights })?;
        estimate.solution = system.solve(&weights, |k| kept[k])?;
        essential = Some(report);
    }
    let looked = position_noise(options, system, &estimate, rows, shift)?;
    // (Σ_j E ψ′_j σ_j⁻² W_jᵀW_j)⁻¹ of weights by row, which is not the covariance of white noise.
    let mut bread = None;
    let mut robust = None;
    if options.estimator == Estimator::Irls {
        let reweighted = reweight(&needed("irls")?, system, &estimate)?;
        estimate.solution.coefficients = reweighted.coefficients;
        estimate.solution.covariance = reweighted.covariance;
        estimate.sigma = reweighted.sigma;
        bread = Some(reweighted.bread);
        robust = Some(reweighted.report);
    }
    if let Some(rows) = rows.filter(|_| options.deviations == Deviations::Memory) {
        remember(rows, system, &mut estimate, bandwidth, bread)?;
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
    // Position noise is not a matter of excitation.
    let judged = calibrated_parameters(model, unit, &estimate.solution, bandwidth);
    if let Some(looked) = &looked {
        looked.shift.widen(&mut estimate.solution.covariance);
    }
    let parameters = calibrated_parameters(model, unit, &estimate.solution, bandwidth);
    let is_eliminated =
        |name: &str| essential.iter().any(|report: &EssentialReport| report.eliminated().any(|e| e == name));
    let judged: Vec<CalibratedParameter> = judged.into_iter().filter(|p| !is_eliminated(&p.name)).collect();
    let inseparable = inseparable(setting, system, &estimate, load)?;
    let inseparable: Vec<(&str, String)> = inseparable
        .iter()
        .map(|d| (model.parameters()[d.column].name.as_str(), d.combinations(model)))
        .collect();
    let robot = model.names();
    let mut warnings = warnings(&judged, &inseparable, estimate.solution.condition_number);
    warnings.extend(rows.and_then(|rows| at_rest(&rows, robot)));
    warnings.extend(consistent.iter().flat_map(|report| report.warnings(robot)));
    warnings.extend(position_bias.iter().filter_map(|bias| bias.overwhelming(robot)));
    warnings.extend(position_bias.iter().filter_map(PositionBias::warning));
    warnings.extend(robust.iter().flat_map(|report| report.warnings(robot)));
    let about_physics = physical::warnings(&physical::Fitted {
        model,
        parameters: &parameters,
        covariance: &estimate.solution.covariance,
        bandwidth,
        ranges: &ranges,
        options,
        unit_of_measurement: unit,
    });
    warnings.extend(about_physics.iter().cloned());
    Ok(Calibration {
        unit,
        options: *options,
        f_dyn_hz,
        warnings,
        about_physics,
        parameters,
        covariance: covariance(&estimate.solution, bandwidth),
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
fn position_noise(
    options: &CalibrationOptions,
    system: &System,
    estimate: &Estimate,
    rows: Option<Observed<'_>>,
    shift: Option<&Shift>,
) -> Result<Option<Looked>, CalibrationError> {
    let Some(rows) = rows.filter(|_| options.tells_position_bias()) else { return Ok(None) };
    let weights = fit_weights(options.estimator, estimate, system);
    look(&Fitted { rows, weights: &weights, solution: &estimate.solution }, shift).map(Some)
}

/// Coefficients that are set to zero since no motion tells them from others.
fn inseparable(
    setting: &Setting<'_>,
    system: &System,
    estimate: &Estimate,
    load: &LoadTorque,
) -> Result<Vec<Dependence>, CalibrationError> {
    let Setting { model, options, .. } = *setting;
    // What was eliminated could have been told.
    if options.estimator == Estimator::Essential || estimate.solution.excited.iter().all(|e| *e) {
        return Ok(Vec::new());
    }
    let found = Dependence::all(system, &fit_weights(options.estimator, estimate, system))?;
    Ok(Dependence::structural(found, model, load))
}

fn fit_weights(estimator: Estimator, estimate: &Estimate, system: &System) -> Vec<f64> {
    if estimator.is_weighted() { weights(&estimate.sigma) } else { ones(system) }
}

/// Puts the covariance of noise with a memory in the place of that of independent rows.
fn remember(
    rows: Observed<'_>,
    system: &System,
    estimate: &mut Estimate,
    bandwidth: f64,
    bread: Option<Vec<f64>>,
) -> Result<(), CalibrationError> {
    let options = rows.options;
    let weights = fit_weights(options.estimator, estimate, system);
    let excited = &estimate.solution.excited;
    // What was eliminated is not fitted.
    let is_fitted = |k: usize| options.estimator != Estimator::Essential || excited[k];
    let mut plain = system.solve(&weights, is_fitted)?;
    if let Some(bread) = bread {
        plain.covariance = bread;
    }
    let sigma = &estimate.sigma;
    let by_row = |joint: usize, residual: f64| Loss::Tukey.weight(residual / sigma[joint]);
    let covariance = Sandwich {
        rows,
        coefficients: &estimate.solution.coefficients,
        weights: &weights,
        bread: &plain.covariance,
        row_weight: (options.estimator == Estimator::Irls).then_some(&by_row),
        lift: None,
    }
    .covariance()?;
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
