//! Estimates that a machine can have: bodies of positive mass, rotors of positive inertia, friction that brakes.
//!
//! Weighted least squares leaves base parameters ζ̂ and the triangle R of its rows; any ζ explains the data worse by
//! χ² = ‖R (ζ − ζ̂)‖²/s. Base parameters are sums of standard parameters π of several links. Sought are π with a positive
//! definite pseudo-inertia P_l for every link and load, rotor inertias and friction such that dissipation is positive, with
//! the least χ²; and, among all that explain the data equally, those that a prior P₀ or the barrier prefers:
//!
//! min ½ χ²(π) + μ [Σ_l (tr P₀⁻¹P_l − log det P₀⁻¹P_l) − Σ_k log (a_kᵀ ζ)],   μ → 0.
//!
//! Descriptions rarely have rotors, and where the model has no term for them either, they are a part of the links in the
//! data. So that the pull does not make mass of them, P_l − J_l D_l is what a prior pulls, with J_l ≥ 0 and D_l a thin
//! disc without mass about the joint's axis.
//!
//! The path is followed until χ² is within a stated amount of the least, so that base parameters stay where the data put
//! them wherever a machine can be there. Sources: Wensing, Kim, Slotine (IEEE RA-L 2018); Lee, Wensing, Park (IEEE T-RO
//! 2020); Sousa, Cortesão (Int. J. Robotics Research 2014); Boyd, Vandenberghe, *Convex Optimization*, chapter 11.

mod assembly;
mod body;
mod inside;
mod newton;
mod prior;
mod program;
mod report;

use nalgebra::{DMatrix, DVector};

pub use assembly::Fit;
pub use body::{PossibleBody, possible_body};
pub use prior::{Prior, PriorError};
pub use report::{ConsistentReport, Moved, StandardEstimate};

use self::assembly::{Assembly, Ground};
use self::prior::{guessed, rotors_of_links};
use crate::CalibrationError;

/// χ² up to which estimates may differ from the best that a machine can have. Base parameters then are within
/// √0.001 = 0.03 standard deviations of where the data put them, all together, where a machine can be there.
const LOSS: f64 = 1e-3;

/// The coefficients of a machine that can exist, next to a weighted least-squares fit.
///
/// # Errors
/// [`CalibrationError::Prior`], [`CalibrationError::Inconsistent`] if no such machine was found, and what models report.
pub fn make_consistent(
    fit: &Fit<'_>,
    prior: Option<&Prior>,
) -> Result<(Vec<f64>, ConsistentReport), CalibrationError> {
    let triangle = fit.system.triangle(fit.weights)?;
    let known = prior.map(|p| p.bodies(fit.model)).transpose()?;
    let bodies = known
        .unwrap_or_else(|| vec![guessed(fit.model, fit.coefficients); fit.model.rigid_body().bodies().len()]);
    let assembly = Assembly::new(Ground {
        fit,
        triangle: &triangle,
        prior: &bodies,
        pull_weight: prior.map_or(0.0, |p| p.weight),
        rotors: &prior.map_or_else(Vec::new, |_| rotors_of_links(fit.model)),
    })?;
    let reached =
        assembly.program.solve(assembly.start.clone(), 0.5 * LOSS).ok_or(CalibrationError::Inconsistent)?;
    let value = |(of, at): &(DMatrix<f64>, DVector<f64>)| of * &reached.at + at;
    let coefficients = value(&assembly.coefficients);
    let standard = value(&assembly.standard);
    if !coefficients.iter().chain(standard.iter()).all(|v| v.is_finite()) {
        return Err(CalibrationError::NotFinite);
    }
    let report = report::report(fit, &assembly, &reached, &coefficients, &standard, prior);
    Ok((coefficients.as_slice().to_vec(), report))
}
