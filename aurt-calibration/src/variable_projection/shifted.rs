//! Shapes and coefficients with the noise of the positions added once more.

use rayon::prelude::*;

use super::owner::Owner;
use super::problem::Problem;
use super::shaped::Shaped;
use super::uncertainty::at_bound;
use crate::errors_in_positions::{DRAWS, Shift, noisier_recordings, position_noise_matters};
use crate::{CalibrationError, CalibrationOptions, FitRows, NamedRecording, RigidRows, TermScopes};

/// By how much noise of the positions is taken to have shifted coefficients and shapes, the latter as shares of their ranges:
/// one step of Gauss and Newton from the minimum, with the noise added once more, for each draw. Shapes at a bound stay there.
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
    // A search ends before the last of its steps: what the recordings as they are ask for is no shift.
    let (plain, excited) = step(shaped, shaped.rows, units, scopes, None)?;
    let all: Vec<usize> = (0..recordings.len()).collect();
    let drawn: Vec<Vec<f64>> = (0..DRAWS)
        .into_par_iter()
        .map(|draw| {
            let noisier = noisier_recordings(&recordings, draw)?;
            let rigid = RigidRows::new(&shaped.model, &noisier)?;
            let rows = FitRows::new(&rigid, &all, options)?;
            Ok(step(shaped, &rows, units, scopes, Some(&excited))?.0)
        })
        .collect::<Result<_, CalibrationError>>()?;
    let owners = Owner::all(&shaped.model);
    let groups: Vec<_> = owners.iter().flat_map(|o| vec![o.group; o.shapes.len()]).collect();
    Ok(Shift::of(&shaped.model, &groups, &plain, &drawn))
}

/// The coefficients, and the steps of all shapes, that rows ask for; and which columns of the system they determine, which
/// may be given: noise determines nothing.
fn step(
    shaped: &Shaped<'_>,
    rows: &FitRows<'_>,
    units: &[Vec<f64>],
    scopes: &TermScopes,
    excited: Option<&[bool]>,
) -> Result<(Vec<f64>, Vec<bool>), CalibrationError> {
    let (model, weights) = (&shaped.model, shaped.weights());
    let acting = rows.acting(model, scopes);
    let loads = rows.loads(model, &shaped.fitted.load)?;
    let problem = Problem::new(model, rows, &acting, &loads, weights.clone())?;
    let point = problem.at(units.to_vec())?;
    let owners: Vec<usize> = (0..units.len()).collect();
    let coefficients = &shaped.fitted.estimate.solution.coefficients;
    let mut free = problem.sensitivities(&point, &owners, coefficients)?;
    free.retain(|s| !at_bound(units[s.shape.0][s.shape.1]));
    let system = problem.system(&point, &free);
    let (found, excited) = match excited {
        Some(excited) => (system.solve_coefficients_of(&weights, |k| excited[k])?, excited.to_vec()),
        None => system.solve_coefficients(&weights)?,
    };
    let n = coefficients.len();
    let shapes = units.iter().enumerate().flat_map(|(o, units)| (0..units.len()).map(move |i| (o, i)));
    let steps = shapes.map(|shape| free.iter().position(|s| s.shape == shape).map_or(0.0, |k| found[n + k]));
    Ok((found[..n].iter().copied().chain(steps).collect(), excited))
}
