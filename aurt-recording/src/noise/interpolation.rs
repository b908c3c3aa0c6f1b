//! What interpolation onto a uniform grid leaves of white noise.

/// How samples are interpolated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interpolator {
    /// Straight lines between the samples (measurements).
    Linear,
    /// The cubic spline through the samples (positions).
    Spline,
}

/// Where the samples of a grid lie between the stamps of a recording, as shares of the distance of stamps.
#[derive(Debug, Clone, PartialEq)]
pub struct Interpolation {
    rate_hz: f64,
    /// The grid's samples by their place between two stamps, in bins: share and mean place. Empty where the grid is
    /// the recording's own.
    places: Vec<[f64; 2]>,
}

/// Bins of the place between two stamps.
const BINS: usize = 16;

impl Interpolation {
    /// Samples that were recorded at `rate_hz` and used as they are.
    pub const fn none(rate_hz: f64) -> Self {
        Self { rate_hz, places: Vec::new() }
    }

    /// Samples recorded at the increasing stamps `time_s`, about `rate_hz` of them a second, and interpolated at the
    /// increasing times of `grid_s`.
    pub fn between(time_s: &[f64], grid_s: &[f64], rate_hz: f64) -> Self {
        let mut places = vec![[0.0; 2]; BINS];
        let mut k = 0;
        let mut count = 0.0;
        for t in grid_s {
            while k + 2 < time_s.len() && *t >= time_s[k + 1] {
                k += 1;
            }
            let Some([from, to]) = time_s.get(k..k + 2).and_then(|w| <[f64; 2]>::try_from(w).ok()) else {
                break;
            };
            let place = ((t - from) / (to - from)).clamp(0.0, 1.0);
            if place.is_finite() {
                let bin = &mut places[((place * BINS as f64) as usize).min(BINS - 1)];
                bin[0] += 1.0;
                bin[1] += place;
                count += 1.0;
            }
        }
        if count == 0.0 {
            return Self::none(rate_hz);
        }
        places.retain(|[samples, _]| *samples > 0.0);
        for [samples, place] in &mut places {
            *place /= *samples;
            *samples /= count;
        }
        Self { rate_hz, places }
    }

    /// Mean |D(f)|² over the grid's samples. With s the share of the distance of stamps, ω = 2πf/rate:
    /// straight lines 1 − 2s(1−s)(1 − cos ω); the spline through equidistant samples
    /// |Σ_k β³(k−s) e^{−iωk}|² / (2/3 + cos(ω)/3)² with the cubic B-spline β³ (Unser 1999).
    pub fn power_gain(&self, frequency_hz: f64, how: Interpolator) -> f64 {
        if self.places.is_empty() {
            return 1.0;
        }
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * frequency_hz / self.rate_hz);
        let gain = |s: f64| match how {
            Interpolator::Linear => 1.0 - 2.0 * s * (1.0 - s) * (1.0 - cos),
            Interpolator::Spline => {
                let y = 1.0 - s;
                let weights = [
                    y * y * y / 6.0,
                    (4.0 - 6.0 * s * s + 3.0 * s * s * s) / 6.0,
                    (4.0 - 6.0 * y * y + 3.0 * y * y * y) / 6.0,
                    s * s * s / 6.0,
                ];
                let (mut re, mut im) = (0.0, 0.0);
                let (mut c, mut d) = (1.0, 0.0);
                for weight in weights {
                    re += weight * c;
                    im += weight * d;
                    (c, d) = (c * cos - d * sin, c * sin + d * cos);
                }
                (re * re + im * im) / ((2.0 + cos) / 3.0).powi(2)
            }
        };
        self.places.iter().map(|[share, place]| share * gain(*place)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::{Interpolation, Interpolator};
    use crate::noise::Normal;
    use crate::preprocess::resample::{grid, linear, smooth};

    #[test]
    fn the_mean_gain_is_the_variance_that_interpolation_leaves() {
        let mut normal = Normal::new(11);
        let time: Vec<f64> = (0..20_000).map(|k| 0.01 * f64::from(k)).collect();
        let noise: Vec<f64> = time.iter().map(|_| normal.next()).collect();
        let grid = grid(0.1, 199.0, 93.0);
        let between = Interpolation::between(&time, &grid, 100.0);
        let power = |x: &[f64]| x.iter().map(|v| v * v).sum::<f64>() / x.len() as f64;
        for (how, values) in [
            (Interpolator::Linear, linear(&time, &noise, grid.iter().copied())),
            (Interpolator::Spline, smooth(&time, &noise, &grid)),
        ] {
            let mean: f64 =
                (0..500).map(|k| between.power_gain(0.1 * (f64::from(k) + 0.5), how)).sum::<f64>() / 500.0;
            assert!((power(&values) / mean - 1.0).abs() < 0.04, "{how:?}: {} {mean}", power(&values));
        }
    }
}
