//! Noise in the positions.
//!
//! The regressor is made from measured positions, and least squares knows only noise of the measurement y: errors ΔW of the
//! regressor pull coefficients towards zero, since E (W + ΔW)ᵀ(W + ΔW) = WᵀW + E ΔWᵀΔW. Adding the noise once more, as the
//! noise model of each joint draws it (white noise, and the lattice of the encoder on the very motion, through the filters of
//! the positions), shows what it does to the normal equations A ζ = c; taking that away once gives them without noise,
//!
//! (2A − E A*) ζ = 2c − E c*,
//!
//! corrected scores by simulation (Nakamura 1990; Novick and Stefanski 2002). Exact where the regressor is linear in the
//! noise; to first order in its power elsewhere. Friction turns with the sign of the velocity, where that is not enough: the
//! correction shows that and where noise matters, and intervals around corrected estimates of friction hold less often than
//! those of least squares (docs/estimation.md). So experiments do not offer it as an estimator. Instead, what the noise added
//! once more does to estimates widens their intervals (`Shift`).

mod hausman;
mod look;
mod noise;
mod normal;
mod report;
mod shift;

pub(crate) use hausman::Tested;
pub(crate) use look::{DRAWS, Fitted, look, noisier_recordings, position_noise_matters};
pub(crate) use report::Looked;
pub(crate) use shift::Shift;

pub use hausman::Hausman;
pub use report::{FittedBandwidth, JointPositionNoise, ParameterBias, PositionBias};
