//! One body alone, from its estimate and the covariance of that.

use nalgebra::{DMatrix, DVector, SMatrix};

use super::prior::ball;
use super::program::{BodyMap, Program};
use crate::physical::{Standard, pseudo_inertia, standard_of};

/// Extra loss up to which the body may differ from the nearest possible one, in squared standard deviations.
const TOLERANCE: f64 = 1e-3;

/// A body that can exist.
#[derive(Debug, Clone, PartialEq)]
pub struct PossibleBody {
    /// {XX XY XZ YY YZ ZZ mX mY mZ m} in the frame of the estimate, inertia about its origin.
    pub standard: [f64; 10],
    /// Squared distance from the estimate in its standard deviations (Mahalanobis).
    pub loss: f64,
}

/// The body that can exist and is nearest to an estimate of ten standard parameters, in the metric of the
/// `covariance` (10 × 10, column-major): min (π − π̂)ᵀ C⁻¹ (π − π̂) subject to a positive definite pseudo-inertia, to
/// within 0.001 of the least. A body that was taken off, one of negative mass, is returned as one.
///
/// None if anything is not finite, the covariance is not positive definite, or the mass is zero.
pub fn possible_body(estimate: &[f64; 10], covariance: &[f64]) -> Option<PossibleBody> {
    let mass = estimate[9];
    let finite = estimate.iter().chain(covariance).all(|v| v.is_finite());
    if !finite || mass == 0.0 || covariance.len() != 100 {
        return None;
    }
    let sign = mass.signum();
    let wanted = Standard::from_row_slice(estimate) * sign;
    let covariance = SMatrix::<f64, 10, 10>::from_column_slice(covariance);
    let deviation = covariance.diagonal().map(f64::sqrt);
    if !deviation.iter().all(|d| *d > 0.0) {
        return None;
    }
    let scaled = SMatrix::<f64, 10, 10>::from_fn(|r, c| covariance[(r, c)] / (deviation[r] * deviation[c]));
    let root = SMatrix::from_diagonal(&deviation) * scaled.cholesky()?.l();
    let centre = wanted.fixed_rows::<3>(6) / wanted[9];
    // A ball about the estimated centre of mass, as large as a tenth of its distance or five centimetres.
    let radius = (0.1 * centre.norm()).max(0.05);
    let prior = ball(centre.into(), radius, wanted[9]);
    let begin = standard_of(&prior);
    let start = root.clone_owned().lu().solve(&(begin - wanted))?;
    let program = Program {
        free: 0,
        seen: 10,
        scale: 1.0,
        bodies: vec![BodyMap {
            of: DMatrix::from_column_slice(10, 10, root.as_slice()),
            at: wanted,
            prior,
            pull_weight: 0.0,
        }],
        positive: Vec::new(),
    };
    let reached = program.solve(DVector::from_column_slice(start.as_slice()), 0.5 * TOLERANCE)?;
    let standard = program.standard(&reached.at)[0] * sign;
    let possible = pseudo_inertia(&(standard * sign).data.0[0]).cholesky().is_some();
    possible.then_some(PossibleBody { standard: standard.data.0[0], loss: 2.0 * reached.loss })
}
