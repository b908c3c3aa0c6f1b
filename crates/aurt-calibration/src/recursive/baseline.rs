use serde::Serialize;

use crate::{
    CalibrationError, Solution,
    student::{normal, student},
    uncertainty::NORMAL_95,
};

/// Fewer windows than this do not tell how much an unchanged machine varies.
pub const MIN_WINDOWS: usize = 6;

/// Windows over which the memory of what the model lacks is followed.
const LAGS: usize = 4;

/// How the drift parameters of an unchanged machine vary from window to window.
///
/// A window's estimate δ has a formal deviation s from noise alone; what the model lacks adds to it. Over N windows of the
/// unchanged machine, m is the mean of δ weighted by 1/s², and c² = Σ ((δ − m)/s)² / (N − 1), at least 1: the deviation
/// of a further window from m is c √(s² + L/Σ s⁻²), in Student's distribution with N − 1 degrees of freedom.
///
/// What the model lacks lasts longer than a window. With ρ_k the correlation of windows k apart, the mean over all parameters,
/// L = 1 + 2 Σ_k (1 − k/(K + 1)) ρ_k, at least 1, is by how much the variance of a mean over many windows exceeds that of
/// independent ones (Newey and West 1987, K = 4).
#[derive(Debug, Clone, Serialize)]
pub struct Baseline {
    /// Windows that determine each parameter.
    pub windows: Vec<usize>,
    /// m.
    pub mean: Vec<f64>,
    /// c.
    pub inflation: Vec<f64>,
    /// L.
    pub memory: f64,
    /// 1/Σ s⁻².
    #[serde(skip)]
    variance_of_mean: Vec<f64>,
}

/// A drift parameter with what is known of its precision; all `None` where the rows do not determine it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Drift {
    /// Change since the baseline.
    pub value: Option<f64>,
    /// 95 % interval.
    pub interval_95: Option<[f64; 2]>,
    /// The innovation, whitened: N(0, 1) while the machine is as the baseline.
    pub standardised: Option<f64>,
}

impl Baseline {
    /// Learns from windows of the unchanged machine.
    ///
    /// # Errors
    /// [`CalibrationError::TooFewWindows`] if no parameter is determined by [`MIN_WINDOWS`] of them.
    pub fn learn(windows: &[Solution]) -> Result<Self, CalibrationError> {
        let parameters = windows.first().map_or(0, |w| w.coefficients.len());
        let mut baseline = Self {
            windows: Vec::new(),
            mean: Vec::new(),
            inflation: Vec::new(),
            memory: 1.0,
            variance_of_mean: Vec::new(),
        };
        let mut series: Vec<Vec<f64>> = Vec::new();
        for k in 0..parameters {
            let known: Vec<(f64, f64)> = windows.iter().filter_map(|w| with_variance(w, k)).collect();
            let information: f64 = known.iter().map(|(_, variance)| 1.0 / variance).sum();
            let mean = known.iter().map(|(value, variance)| value / variance).sum::<f64>() / information;
            let squares: f64 = known.iter().map(|(value, variance)| (value - mean).powi(2) / variance).sum();
            if known.len() >= MIN_WINDOWS {
                series.push(known.iter().map(|(value, variance)| (value - mean) / variance.sqrt()).collect());
            }
            baseline.windows.push(known.len());
            baseline.mean.push(mean);
            baseline.inflation.push((squares / known.len().saturating_sub(1).max(1) as f64).sqrt().max(1.0));
            baseline.variance_of_mean.push(1.0 / information);
        }
        let found = baseline.windows.iter().copied().max().unwrap_or(0);
        if found < MIN_WINDOWS {
            return Err(CalibrationError::TooFewWindows { found: windows.len(), needed: MIN_WINDOWS });
        }
        baseline.memory = memory(&series);
        Ok(baseline)
    }

    /// What the rows of a window say of a parameter; nothing where they or the baseline's do not determine it.
    #[must_use]
    pub fn drift(&self, solution: &Solution, parameter: usize) -> Drift {
        self.drift_over(solution, parameter, 1.0)
    }

    /// As [`Self::drift`], of the rows of many windows, which do not err independently.
    #[must_use]
    pub fn drift_of_many(&self, solution: &Solution, parameter: usize) -> Drift {
        self.drift_over(solution, parameter, self.memory)
    }

    fn drift_over(&self, solution: &Solution, parameter: usize, memory: f64) -> Drift {
        let known = self.windows[parameter] >= MIN_WINDOWS;
        let Some((value, variance)) = with_variance(solution, parameter).filter(|_| known) else {
            return Drift { value: None, interval_95: None, standardised: None };
        };
        let freedom = (self.windows[parameter] - 1) as f64;
        let std = self.inflation[parameter]
            * (memory * variance + self.memory * self.variance_of_mean[parameter]).sqrt();
        let value = value - self.mean[parameter];
        let half = std * student(NORMAL_95, freedom);
        Drift {
            value: Some(value),
            interval_95: Some([value - half, value + half]),
            standardised: Some(normal(value / std, freedom)),
        }
    }

    /// How far the mean of a parameter may be off, in deviations of a window, at two standard deviations.
    #[must_use]
    pub fn mean_error(&self, parameter: usize) -> f64 {
        2.0 * (self.memory / self.windows[parameter].max(1) as f64).sqrt()
    }
}

/// L of some series of deviations from their means.
fn memory(series: &[Vec<f64>]) -> f64 {
    let correlation = |lag: usize| -> f64 {
        let of = |z: &Vec<f64>| {
            let power: f64 = z.iter().map(|z| z * z).sum();
            let product: f64 = z.iter().zip(z.iter().skip(lag)).map(|(a, b)| a * b).sum();
            // Taking away the mean lowers the correlation by about one part in as many windows as there are.
            (if power > 0.0 { product / power } else { 0.0 }) + 1.0 / z.len() as f64
        };
        series.iter().map(of).sum::<f64>() / series.len().max(1) as f64
    };
    let shortest = series.iter().map(Vec::len).min().unwrap_or(0);
    let lags = LAGS.min(shortest / 4);
    let sum: f64 = (1..=lags).map(|k| (1.0 - k as f64 / (lags + 1) as f64) * correlation(k)).sum();
    (1.0 + 2.0 * sum).max(1.0)
}

fn with_variance(solution: &Solution, k: usize) -> Option<(f64, f64)> {
    let variance = solution.covariance[k * solution.coefficients.len() + k];
    (solution.excited[k] && variance > 0.0 && variance.is_finite())
        .then_some((solution.coefficients[k], variance))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn window(value: f64, std: f64) -> Solution {
        Solution {
            coefficients: vec![value],
            excited: vec![true],
            residual_sum: Vec::new(),
            covariance: vec![std * std],
            condition_number: 1.0,
        }
    }

    /// A first-order autoregression of ρ = 0.6 has L = (1 + ρ)/(1 − ρ) = 4, of which four weighted lags show 2.6.
    #[test]
    fn memory_is_seen_over_windows() {
        let mut state = 1_u64;
        let mut noise = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let independent: Vec<Vec<f64>> = (0..12).map(|_| (0..200).map(|_| noise()).collect()).collect();
        assert!(memory(&independent) < 1.2, "{}", memory(&independent));
        let mut before = 0.0;
        let mut next = || {
            before = 0.6 * before + noise();
            before
        };
        let lasting: Vec<Vec<f64>> = (0..12).map(|_| (0..200).map(|_| next()).collect()).collect();
        assert!((2.2..3.0).contains(&memory(&lasting)), "{}", memory(&lasting));
    }

    #[test]
    fn what_the_model_lacks_widens_intervals() {
        let spread = |by: f64| -> Vec<Solution> {
            (0..10).map(|i| window(1.0 + by * f64::from(i % 2 * 2 - 1), 0.1)).collect()
        };
        let narrow = Baseline::learn(&spread(0.0)).unwrap().drift(&window(1.5, 0.1), 0);
        let wide = Baseline::learn(&spread(0.5)).unwrap().drift(&window(1.5, 0.1), 0);
        assert!((narrow.value.unwrap() - 0.5).abs() < 1e-12);
        assert!(narrow.standardised.unwrap() > 2.5 && wide.standardised.unwrap() < 1.5);
        assert!(narrow.interval_95.unwrap()[0] > 0.0 && wide.interval_95.unwrap()[0] < 0.0);
        let too_few = Baseline::learn(&spread(0.1)[..5]).unwrap_err();
        assert!(matches!(too_few, CalibrationError::TooFewWindows { found: 5, .. }));
    }
}
