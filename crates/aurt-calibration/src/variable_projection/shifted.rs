//! Shapes and coefficients with the noise of the positions added once more.

use rayon::prelude::*;

use super::{
    fitting::Shaped,
    owner::Owner,
    problem::{Point, Problem},
    uncertainty::at_bound,
};
use crate::{
    CalibrationError, CalibrationOptions, FitRows, NamedRecording, RigidRows, TermScopes,
    errors_in_positions::{DRAWS, Shift, noisier_recordings, position_noise_matters},
};

/// The most by which noise of the positions may have shifted coefficients and shapes, the latter as shares of their ranges:
/// one step of Gauss and Newton from the minimum, with the noise added once more, for each draw.
///
/// # Errors
/// What models report.
pub(super) fn shift(
    shaped: &Shaped<'_>,
    units: &[Vec<f64>],
    scopes: &TermScopes,
    options: &CalibrationOptions,
) -> Result<Shift, CalibrationError> {
    let recordings: Vec<&NamedRecording> = shaped.rows.recordings().collect();
    if !position_noise_matters(&shaped.model, &recordings)? {
        return Ok(Shift::default());
    }
    let drawn: Vec<Vec<f64>> = (0..DRAWS[0])
        .into_par_iter()
        .map(|draw| {
            let noisier = noisier_recordings(&recordings, draw)?;
            step(shaped, &noisier, units, scopes, options)
        })
        .collect::<Result<_, CalibrationError>>()?;
    // A search ends before the last of its steps: what the recordings as they are ask for is no shift.
    let own: Vec<NamedRecording> = recordings.into_iter().cloned().collect();
    let plain = step(shaped, &own, units, scopes, options)?;
    Ok(Shift::of(&shaped.model, &plain, &drawn))
}

/// The coefficients, and the steps of all shapes, that other recordings ask for.
fn step(
    shaped: &Shaped<'_>,
    recordings: &[NamedRecording],
    units: &[Vec<f64>],
    scopes: &TermScopes,
    options: &CalibrationOptions,
) -> Result<Vec<f64>, CalibrationError> {
    let model = &shaped.model;
    let rigid = RigidRows::new(model, recordings)?;
    let all: Vec<usize> = (0..recordings.len()).collect();
    let rows = FitRows::new(&rigid, &all, options)?;
    let acting = rows.acting(model, scopes);
    let loads = rows.loads(model, &shaped.fitted.load)?;
    let problem = Problem::new(model, &rows, &acting, &loads, shaped.weights())?;
    let point: Point = problem.at(units.to_vec())?;
    let owners: Vec<usize> = (0..Owner::all(model).len()).collect();
    let coefficients = &shaped.fitted.estimate.solution.coefficients;
    let mut free = problem.sensitivities(&point, &owners, coefficients)?;
    free.retain(|s| !at_bound(units[s.shape.0][s.shape.1]));
    let (found, _) = problem.system(&point, &free).solve_coefficients(&shaped.weights())?;
    let n = coefficients.len();
    let steps = units.iter().enumerate().flat_map(|(o, units)| (0..units.len()).map(move |i| (o, i)));
    let steps = steps.map(|shape| free.iter().position(|s| s.shape == shape).map_or(0.0, |k| found[n + k]));
    Ok(found[..n].iter().copied().chain(steps).collect())
}
