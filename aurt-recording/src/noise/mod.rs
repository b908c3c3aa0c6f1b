//! The noise of a series of samples: its levels, its spectrum, and what interpolation and filters leave of it.
//!
//! All power spectra are one-sided: their integral from 0 to half the sampling rate is a variance.

mod fourier;
mod interpolation;
mod lattice;
mod markov;
mod position;
mod response;
mod spectrum;
mod white;

pub(crate) use fourier::power;
#[cfg(test)]
pub(crate) use fourier::tests::Normal;
pub use interpolation::{Interpolation, Interpolator};
pub use lattice::lattice_step;
pub use markov::WhiteAndMarkov;
pub use position::PositionNoise;
pub use response::{acceleration_gain, velocity_gain};
pub use spectrum::{MedianSpectrum, SpectrumBand};
pub use white::white_level_at;

/// The median of at least one value; the values are reordered.
pub fn median(values: &mut [f64]) -> f64 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The median distance of stamps that differ, s; none without two.
pub fn median_step_s(time_s: &[f64]) -> Option<f64> {
    let mut steps: Vec<f64> = time_s.windows(2).map(|w| w[1] - w[0]).filter(|d| *d > 0.0).collect();
    (!steps.is_empty()).then(|| median(&mut steps))
}
