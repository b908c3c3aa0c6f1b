use aurt_traits::{MeasurementUnit, RobotModel};

use super::damped::ShapeOptions;
use super::owner::Owner;
use super::report::ShapeReport;
use super::search::{Found, search_box, search_nearby};
use super::shaped::Shaped;
use super::shifted::shift;
use super::uncertainty::precision;
use crate::calibrate::Setting;
use crate::row_cache::fit;
use crate::{
    Calibration, CalibrationError, CalibrationOptions, FitRows, NamedRecording, RigidRows, TermScopes,
    calibrate_scoped,
};

/// Weights and load torque follow the shapes at most this often.
const MOST_ROUNDS: usize = 6;
/// Shapes that move by less than this share of their range when weights and load torque follow stay.
const SETTLED: f64 = 1e-4;

/// Estimates coefficients and shape parameters of a model from recordings, by variable projection around
/// [`calibrate_scoped`]; the model that comes back has the shapes found. A model without shape parameters comes back
/// as it is, and so does any if [`CalibrationOptions::fit_shapes`] is false.
///
/// The shapes that `model` has are one of the starts.
///
/// # Errors
/// As [`calibrate_scoped`].
pub fn calibrate_shapes(
    model: &RobotModel,
    recordings: &[NamedRecording],
    scopes: &TermScopes,
    unit: MeasurementUnit,
    f_dyn_hz: f64,
    options: &CalibrationOptions,
    search: &ShapeOptions,
) -> Result<(RobotModel, Calibration), CalibrationError> {
    if !options.fit_shapes || Owner::all(model).is_empty() || recordings.is_empty() {
        let calibration = calibrate_scoped(model, recordings, scopes, unit, f_dyn_hz, options)?;
        return Ok((model.clone(), calibration));
    }
    let rigid = RigidRows::new(model, recordings)?;
    let all: Vec<usize> = (0..recordings.len()).collect();
    let rows = FitRows::new(&rigid, &all, options)?;
    calibrate_shapes_rows(model, &rows, scopes, unit, f_dyn_hz, options, search)
}

/// As [`calibrate_shapes`], from shared rows.
///
/// # Errors
/// As [`calibrate_scoped`]; [`CalibrationError::Columns`] for a model of other rigid bodies.
pub fn calibrate_shapes_rows(
    model: &RobotModel,
    rows: &FitRows<'_>,
    scopes: &TermScopes,
    unit: MeasurementUnit,
    f_dyn_hz: f64,
    options: &CalibrationOptions,
    search: &ShapeOptions,
) -> Result<(RobotModel, Calibration), CalibrationError> {
    let owners = Owner::all(model);
    if !options.fit_shapes || owners.is_empty() {
        let setting = Setting { model, unit, f_dyn_hz, options };
        let fitted = fit(model, rows, scopes, options)?;
        let calibration = rows.calibration(&setting, &fitted, scopes, None)?;
        return Ok((model.clone(), calibration));
    }
    let mut shaped = Shaped::begin(model, rows, scopes, options)?;
    let mut found: Option<Found> = None;
    let (mut evaluations, mut iterations, mut settled) = (0, 0, false);
    for _ in 0..MOST_ROUNDS {
        let problem = shaped.problem()?;
        let start = problem.at(problem.owners.iter().map(Owner::units).collect())?;
        let before = start.units.clone();
        let descent = match &mut found {
            None => {
                let all = search_box(&problem, start, search)?;
                let descent = all.descent.clone();
                found = Some(all);
                descent
            }
            Some(found) => {
                found.descent = search_nearby(&problem, start, search)?;
                found.descent.clone()
            }
        };
        evaluations += problem.evaluations();
        iterations += descent.iterations;
        let moved = furthest(&before, &descent.point.units);
        let model = problem.model_at(&descent.point)?;
        shaped = Shaped::begin(&model, rows, scopes, options)?;
        if moved < SETTLED {
            settled = descent.converged;
            break;
        }
    }
    let Some(found) = found else { return Err(CalibrationError::NotFinite) };
    let problem = shaped.problem()?;
    let point = problem.at(problem.owners.iter().map(Owner::units).collect())?;
    let cost_before = problem.at(owners.iter().map(Owner::units).collect()).map_or(f64::INFINITY, |p| p.cost);
    let bandwidth = rows.bandwidth();
    let coefficients = shaped.fitted.estimate.solution.coefficients.clone();
    let precision =
        precision(&problem, &point, &found, &owners, &coefficients, (unit, options.estimator, bandwidth))?;
    let count = shaped.fitted.system.factors().iter().map(crate::JointFactor::rows).sum::<usize>() as f64;
    let mut report = ShapeReport {
        shapes: precision.shapes,
        starts: found.starts,
        iterations,
        evaluations,
        converged: settled,
        cost_before: cost_before / count,
        cost_after: point.cost / count,
    };
    drop(problem);
    let told = options.tells_position_bias();
    let shift = told.then(|| shift(&shaped, &point.units, scopes, options)).transpose()?;
    let Shaped { model, mut fitted, .. } = shaped;
    fitted.estimate.solution.covariance = precision.covariance;
    let mut calibration = rows.calibration(
        &Setting { model: &model, unit, f_dyn_hz, options },
        &fitted,
        scopes,
        shift.as_ref(),
    )?;
    let white: Vec<f64> = fitted
        .estimate
        .solution
        .covariance
        .iter()
        .step_by(calibration.parameters.len() + 1)
        .map(|v| (bandwidth * v).sqrt())
        .collect();
    report.widen(&model, &calibration.parameters, &white, &shift.unwrap_or_default());
    calibration.about_physics.extend(report.bounded());
    calibration.warnings.extend(report.warnings());
    calibration.shape_fit = Some(report);
    Ok((model, calibration))
}

/// The largest change of any shape.
fn furthest(before: &[Vec<f64>], after: &[Vec<f64>]) -> f64 {
    before.iter().flatten().zip(after.iter().flatten()).fold(0.0, |a, (x, y)| f64::max(a, (x - y).abs()))
}
