//! The noise of a series of samples: its levels, its spectrum, and what interpolation and filters leave of it.
//!
//! All power spectra are one-sided: their integral from 0 to half the sampling rate is a variance.

mod fourier;
mod interpolation;
mod lattice;
mod markov;
pub(crate) mod median;
mod position;
mod response;
mod spectrum;
mod white;

pub use interpolation::{Interpolation, Interpolator};
pub use lattice::lattice_step;
pub use markov::WhiteAndMarkov;
pub use median::{median, median_step_s};
pub use position::PositionNoise;
pub use response::{acceleration_gain, velocity_gain};
pub use spectrum::{MedianSpectrum, SpectrumBand};
pub use white::{white_level, white_level_at};
