//! Positions, velocities and accelerations of a recording by local polynomials.

use aurt_recording::Recording;
use nalgebra::{Matrix4, Vector4};

use crate::error::SimulationError;

/// The motion of a recording at its own time stamps, whatever their spacing.
///
/// At every stamp a cubic is fitted to the positions around it, weighted by a Gaussian in time of standard deviation s;
/// its value and derivatives there are q, q̇ and q̈. A local cubic passes a sine of angular frequency ω with the gain
/// (1 + x) e^{−x}, x = (ω s)²/2, so that it is 3 dB down at ω s = 1.48.
#[derive(Debug, Clone, PartialEq)]
pub struct Smoothed {
    pub time_s: Vec<f64>,
    /// q, `[joint][sample]`, rad.
    pub position_rad: Vec<Vec<f64>>,
    /// q̇, rad/s.
    pub velocity_rad_s: Vec<Vec<f64>>,
    /// q̈, rad/s².
    pub acceleration_rad_s2: Vec<Vec<f64>>,
}

/// Where the smoother is 3 dB down, in multiples of f_dyn: above the 2 f_dyn that the measurement is filtered at, so
/// that what is added loses nothing there, and below the 5 f_dyn of the position filter, whose noise it avoids.
const CUT_OFF: f64 = 3.0;
/// ω s at which a local cubic is 3 dB down.
const THREE_DB: f64 = 1.48;
/// Weights end here, in standard deviations: what lies beyond weighs less than 3·10⁻⁴.
const REACH: f64 = 4.0;
/// How often the weights may be widened where a gap leaves too few samples for a cubic.
const WIDENINGS: usize = 12;

impl Smoothed {
    /// The smoothed motion of a recording of dynamics up to `f_dyn_hz`.
    ///
    /// # Errors
    /// [`SimulationError::Preprocessing`] if the recording has too few samples for a cubic.
    pub fn new(recording: &Recording, f_dyn_hz: f64) -> Result<Self, SimulationError> {
        let (joints, samples) = (recording.joints(), recording.samples());
        let spread_s = THREE_DB / (std::f64::consts::TAU * CUT_OFF * f_dyn_hz);
        let series = || vec![vec![0.0; samples]; joints];
        let mut smoothed = Self {
            time_s: recording.time_s.clone(),
            position_rad: series(),
            velocity_rad_s: series(),
            acceleration_rad_s2: series(),
        };
        for k in 0..samples {
            smoothed.fit_at(k, spread_s, recording)?;
        }
        Ok(smoothed)
    }

    fn fit_at(&mut self, k: usize, spread_s: f64, recording: &Recording) -> Result<(), SimulationError> {
        let time = &recording.time_s;
        let mut spread = spread_s;
        for _ in 0..WIDENINGS {
            let first = time.partition_point(|t| *t < time[k] - REACH * spread);
            let end = time.partition_point(|t| *t <= time[k] + REACH * spread);
            let mut moments = [0.0; 7];
            let weights: Vec<(f64, f64)> = time[first..end]
                .iter()
                .map(|t| {
                    let u = (t - time[k]) / spread;
                    let w = libm::exp(-0.5 * u * u);
                    let mut power = w;
                    for moment in &mut moments {
                        *moment += power;
                        power *= u;
                    }
                    (u, w)
                })
                .collect();
            let normal = Matrix4::from_fn(|r, c| moments[r + c]);
            // Fewer than a handful of samples determine no cubic, or one that follows every error.
            let factor = if end - first >= 6 { normal.cholesky() } else { None };
            let Some(factor) = factor else {
                spread *= 1.5;
                continue;
            };
            for (j, positions) in recording.position_rad.iter().enumerate() {
                // Relative to the sample itself, so that large angles lose no digits.
                let here = positions[k];
                let mut right = Vector4::zeros();
                for ((u, w), q) in weights.iter().zip(&positions[first..end]) {
                    let mut power = w * (q - here);
                    for entry in right.iter_mut() {
                        *entry += power;
                        power *= u;
                    }
                }
                let cubic = factor.solve(&right);
                self.position_rad[j][k] = here + cubic[0];
                self.velocity_rad_s[j][k] = cubic[1] / spread;
                self.acceleration_rad_s2[j][k] = 2.0 * cubic[2] / (spread * spread);
            }
            return Ok(());
        }
        Err(SimulationError::Preprocessing {
            reason: format!(
                "{}: {} samples are too few to differentiate around {:.3} s; record longer",
                recording.file.display(),
                time.len(),
                time[k]
            ),
        })
    }

    pub fn joints(&self) -> usize {
        self.position_rad.len()
    }

    pub fn samples(&self) -> usize {
        self.time_s.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sine at stamps that jitter, with a gap: value and derivatives come back.
    #[test]
    fn derivatives_of_a_sine_at_uneven_stamps() {
        let time_s: Vec<f64> = (0..1000)
            .map(|k| f64::from(k) * 0.01 + 0.002 * libm::sin(7.0 * f64::from(k)))
            .filter(|t| !(4.0..4.06).contains(t))
            .collect();
        let omega = 2.0;
        let sine = time_s.iter().map(|t| 3.0 + libm::sin(omega * t)).collect();
        let recording = Recording::from_arrays(time_s, vec![sine]).unwrap();
        let smoothed = Smoothed::new(&recording, 5.0).unwrap();
        for k in 20..smoothed.samples() - 20 {
            let t = smoothed.time_s[k];
            assert!((smoothed.position_rad[0][k] - 3.0 - libm::sin(omega * t)).abs() < 1e-4);
            assert!((smoothed.velocity_rad_s[0][k] - omega * libm::cos(omega * t)).abs() < 5e-3);
            let acceleration = -omega * omega * libm::sin(omega * t);
            assert!((smoothed.acceleration_rad_s2[0][k] - acceleration).abs() < 5e-2, "{t}");
        }
    }

    #[test]
    fn too_few_samples_are_refused() {
        let recording = Recording::from_arrays(vec![0.0, 0.01, 0.02], vec![vec![0.0; 3]]).unwrap();
        let text = Smoothed::new(&recording, 5.0).unwrap_err().to_string();
        assert!(text.contains("3 samples are too few"), "{text}");
    }
}
