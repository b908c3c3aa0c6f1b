//! Gains of the stencils that differentiate, at a frequency.

use std::f64::consts::PI;

/// |A(f)| of the stencil q̈_k = (q_{k+1} − 2q_k + q_{k−1})/T², in 1/s²: (2 sin(πfT)/T)², which is (2πf)² far below half
/// the sampling rate 1/T.
pub fn acceleration_gain(frequency_hz: f64, rate_hz: f64) -> f64 {
    (2.0 * rate_hz * libm::sin(PI * frequency_hz / rate_hz)).powi(2)
}

/// |V(f)| of central differences q̇_k = (q_{k+1} − q_{k−1})/2T, in 1/s: sin(2πfT)/T, which is 2πf far below half the
/// sampling rate 1/T.
pub fn velocity_gain(frequency_hz: f64, rate_hz: f64) -> f64 {
    (rate_hz * libm::sin(2.0 * PI * frequency_hz / rate_hz)).abs()
}

#[cfg(test)]
mod tests {
    use super::{acceleration_gain, velocity_gain};
    use crate::preprocess::span::{inner_acceleration, velocity};

    #[test]
    fn a_sine_is_scaled_by_them() {
        let (rate_hz, frequency_hz) = (200.0, 37.0);
        let series: Vec<f64> =
            (0..400).map(|k| (std::f64::consts::TAU * frequency_hz * f64::from(k) / rate_hz).sin()).collect();
        let rms = |x: &[f64]| (x.iter().map(|v| v * v).sum::<f64>() / x.len() as f64).sqrt();
        let own = rms(&series);
        let speed = rms(&velocity(&series, 1.0 / rate_hz)[1..399]) / own;
        assert!((speed / velocity_gain(frequency_hz, rate_hz) - 1.0).abs() < 0.01);
        let acceleration = rms(&inner_acceleration(&series, 1.0 / rate_hz)) / own;
        assert!((acceleration / acceleration_gain(frequency_hz, rate_hz) - 1.0).abs() < 0.01);
    }
}
