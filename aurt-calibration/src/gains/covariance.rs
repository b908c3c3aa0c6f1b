//! How sure gains are.

use aurt_traits::LoadTorque;
use nalgebra::DMatrix;

use super::problem::{Point, Problem, Seen};
use super::recorded::GainsOf;
use crate::deviations::{Lift, Sandwich};
use crate::rows::Observed;
use crate::system::weights;
use crate::{CalibrationError, NamedRecording};

/// The covariance of log g_j, of noise with the memory that residuals have, at least that of white noise.
pub(super) fn covariance(
    of: &GainsOf<'_>,
    load: &LoadTorque,
    problem: &Problem,
    point: &Point,
    seen: &Seen,
) -> Result<DMatrix<f64>, CalibrationError> {
    // With measurements as torques the model is linear in the coefficients, and W_j ζ is what turns with log a_j.
    let torques: Vec<NamedRecording> = of.recordings.iter().map(|r| as_torques(r, &point.inverse)).collect();
    let torques: Vec<&NamedRecording> = torques.iter().collect();
    let per_torque: Vec<f64> =
        weights(&point.sigma).iter().zip(&point.inverse).map(|(w, a)| (w * a).abs()).collect();
    let n = problem.free.len();
    let joints = of.model.joints();
    let transposed = (0..joints)
        .map(|joint| {
            let mut map = DMatrix::zeros(n + joints, point.coefficients.len());
            problem.free.iter().enumerate().for_each(|(place, k)| map[(place, *k)] = 1.0);
            for k in problem.factors()[joint].columns() {
                map[(n + joint, *k)] = point.coefficients[*k];
            }
            map
        })
        .collect();
    let mut groups: Vec<_> = of
        .model
        .groups()
        .iter()
        .map(|(_, range)| {
            let place = |k: usize| problem.free.partition_point(|f| *f < k);
            place(range.start)..place(range.end)
        })
        .collect();
    groups.push(n..n + joints);
    let lift = Lift { transposed, groups };
    let rows =
        Observed { model: of.model, recordings: &torques, scopes: of.scopes, load, options: of.options };
    let found = Sandwich {
        rows,
        coefficients: &point.coefficients,
        weights: &per_torque,
        bread: seen.inverse.as_slice(),
        row_weight: None,
        lift: Some(&lift),
    }
    .covariance()?;
    let found = DMatrix::from_column_slice(n + joints, n + joints, &found);
    let found = found.view((n, n), (joints, joints)).into_owned();
    let least = white(of, problem, seen);
    let surer = |k: usize| {
        let factor = (least[(k, k)] / found[(k, k)]).max(1.0).sqrt();
        if factor.is_finite() { factor } else { 1.0 }
    };
    Ok(DMatrix::from_fn(joints, joints, |r, c| found[(r, c)] * surer(r) * surer(c)))
}

/// The covariance of log g_j if the noise of the measurement is white.
pub(super) fn white(of: &GainsOf<'_>, problem: &Problem, seen: &Seen) -> DMatrix<f64> {
    let (n, joints) = (problem.free.len(), of.model.joints());
    of.bandwidth() * seen.inverse.view((n, n), (joints, joints)).into_owned()
}

fn as_torques(recording: &NamedRecording, inverse: &[f64]) -> NamedRecording {
    let mut torques = recording.clone();
    for measurement in torques.data.segments.iter_mut().filter_map(|s| s.measurement.as_mut()) {
        for (series, a) in measurement.iter_mut().zip(inverse) {
            series.iter_mut().for_each(|y| *y /= a);
        }
    }
    torques
}
