//! What a current sensor shows beside white noise: noise with memory, and the ripple of the drive.

use serde::{Deserialize, Serialize};

use crate::random::Random;

/// First-order Gauss–Markov noise, dn = −n/T dt + σ √(2/T) dw: what amplifiers, loads of the mains and the current loop
/// leave below some corner frequency 1/(2πT).
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NoiseMemory {
    /// σ, Nm; 0 for none.
    pub deviation_nm: f64,
    /// T, s.
    pub time_constant_s: f64,
}

/// Ripple of the drive's current: amplitude · sin(order · q + phase).
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriveRipple {
    /// Amplitude, Nm; 0 for none.
    pub amplitude_nm: f64,
    /// Periods per revolution of the joint.
    pub order: f64,
    pub phase_rad: f64,
}

impl DriveRipple {
    pub(super) fn at(&self, angle_rad: f64) -> f64 {
        if self.amplitude_nm == 0.0 {
            return 0.0;
        }
        self.amplitude_nm * libm::sin(self.order * angle_rad + self.phase_rad)
    }
}

/// A stream of Gauss–Markov noise, exact for rows at any distance (Ornstein and Uhlenbeck 1930).
#[derive(Debug)]
pub(super) struct Wander {
    memory: NoiseMemory,
    random: Random,
    /// Time of the last row and the noise then.
    last: Option<(f64, f64)>,
}

impl Wander {
    pub fn new(memory: NoiseMemory, seed: u64, joint: usize) -> Self {
        Self { memory, random: Random::labelled(seed, &format!("current memory {joint}")), last: None }
    }

    /// The noise at `time_s`, which is not before that of the last call, Nm.
    pub fn at(&mut self, time_s: f64) -> f64 {
        let NoiseMemory { deviation_nm, time_constant_s } = self.memory;
        if deviation_nm == 0.0 {
            return 0.0;
        }
        let kept = self.last.map_or(0.0, |(before_s, _)| {
            libm::exp(-(time_s - before_s).max(0.0) / time_constant_s.max(1e-9))
        });
        let fresh = deviation_nm * (1.0 - kept * kept).max(0.0).sqrt() * self.random.normal();
        let value = kept * self.last.map_or(0.0, |(_, value)| value) + fresh;
        self.last = Some((time_s, value));
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Variance and correlation over one time constant are those of the process, whatever the rows' distance.
    #[test]
    fn noise_remembers_for_its_time_constant() {
        let memory = NoiseMemory { deviation_nm: 2.0, time_constant_s: 0.1 };
        for (step_s, rows) in [(0.01, 200_000), (0.05, 60_000)] {
            let mut wander = Wander::new(memory, 5, 0);
            let values: Vec<f64> = (0..rows).map(|k| wander.at(f64::from(k) * step_s)).collect();
            let mean_product = |lag: usize| {
                values.iter().zip(&values[lag..]).map(|(a, b)| a * b).sum::<f64>() / f64::from(rows)
            };
            let lag = (0.1_f64 / step_s).round() as usize;
            assert!((mean_product(0) - 4.0).abs() < 0.2, "{}", mean_product(0));
            assert!((mean_product(lag) / mean_product(0) - 0.368).abs() < 0.04, "{step_s}");
        }
        let silent = NoiseMemory::default();
        assert_eq!(Wander::new(silent, 5, 0).at(1.0), 0.0);
    }
}
