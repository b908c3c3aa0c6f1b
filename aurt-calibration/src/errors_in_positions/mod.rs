//! Noise in the positions.
//!
//! The regressor is made from measured positions, and least squares knows only noise of the measurement y: errors ΔW of the
//! regressor pull coefficients towards zero, since E (W + ΔW)ᵀ(W + ΔW) = WᵀW + E ΔWᵀΔW. Adding the noise once more, as the
//! noise model of each joint draws it (white noise, and the lattice of the encoder on the very motion, through the filters of
//! the positions), shows by how much it shifts estimates (Nakamura 1990; Novick and Stefanski 2002). Exact where the regressor
//! is linear in the noise; to first order in its power elsewhere. Friction turns with the sign of the velocity, where that is
//! not enough. So the shift is not taken off: it widens their intervals (`Shift`).

mod look;
mod noise;
mod report;
mod shift;

pub(crate) use look::{DRAWS, Fitted, look, noisier_recordings, position_noise_matters};
pub(crate) use report::Looked;
pub(crate) use shift::Shift;

pub use report::{FittedBandwidth, JointPositionNoise, ParameterBias, PositionBias};
