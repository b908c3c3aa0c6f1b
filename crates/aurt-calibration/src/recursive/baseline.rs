use serde::Serialize;

use super::DriftGroup;
use crate::{
    CalibrationError, Solution,
    student::{low_chi_squared, student},
    uncertainty::NORMAL_95,
};

/// Fewer windows than this do not tell how much an unchanged machine varies.
pub const MIN_WINDOWS: usize = 6;

/// Windows over which the memory of what the model lacks is followed.
const LAGS: usize = 4;

/// As many degrees of freedom of its own motions does the spread of a parameter's whole group count.
const FREEDOM_OF_GROUP: f64 = 4.0;

/// How the drift parameters of an unchanged machine vary from window to window and from motion to motion.
///
/// A window's estimate δ has a formal deviation s from noise alone; what the model lacks adds to it, within a motion and as an effect
/// u of the motion that all its windows share (a recording is a motion),
///
/// δ_ri = m + u_r + e_ri,  u_r ~ N(0, τ²),  e_ri ~ N(0, c² s_ri²).
///
/// With δ_r the mean of motion r weighted by 1/s², of information I_r = Σ_i s_ri⁻², over N windows of R motions,
/// c² = Σ_ri ((δ_ri − δ_r)/s_ri)² / (N − R), at least 1, and F = Σ_r I_r (δ_r − δ)² / (c² (R − 1)) is 1 in the mean without effects of
/// motions and 1 + τ² I/c² with them, I = (ΣI_r − ΣI_r²/ΣI_r)/(R − 1) (DerSimonian and Laird 1986). Motions are few: each
/// parameter's F is drawn towards that of its group, as by four more degrees of freedom.
///
/// What the model lacks may last longer than a window within a motion as well. With ρ_k the correlation of windows k apart, the
/// mean over all parameters, L = 1 + 2 Σ_k (1 − k/(K + 1)) ρ_k, at least 1, is by how much the variance of a mean over many windows
/// exceeds that of independent ones (Newey and West 1987, K = 4).
#[derive(Debug, Clone, Serialize)]
pub struct Baseline {
    /// Windows that determine each parameter.
    pub windows: Vec<usize>,
    /// Motions that these are of.
    pub motions: Vec<usize>,
    /// m.
    pub mean: Vec<f64>,
    /// c.
    pub inflation: Vec<f64>,
    /// τ.
    pub between_motions: Vec<f64>,
    /// What τ is below with 75 % probability.
    pub between_motions_most: Vec<f64>,
    /// L.
    pub memory: f64,
    /// Variance of m.
    #[serde(skip)]
    variance_of_mean: Vec<f64>,
    /// Variance of a window, noise and misfit within its motion.
    #[serde(skip)]
    variance_of_window: Vec<f64>,
}

/// A drift parameter with what is known of its precision; all `None` where the rows do not determine it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Drift {
    /// Change since the baseline.
    pub value: Option<f64>,
    /// 95 % interval.
    pub interval_95: Option<[f64; 2]>,
}

/// The windows of one parameter.
struct Spread {
    windows: usize,
    /// δ_r and I_r.
    motions: Vec<(f64, f64)>,
    within: f64,
    /// Σ_r I_r (δ_r − δ)² / c².
    between: f64,
    /// (ΣI_r − ΣI_r²/ΣI_r)/(R − 1).
    information: f64,
}

impl Spread {
    fn of(motions: &[Vec<(f64, f64)>]) -> Self {
        let windows: usize = motions.iter().map(Vec::len).sum();
        let mut means = Vec::new();
        let mut squares = 0.0;
        for motion in motions.iter().filter(|m| !m.is_empty()) {
            let information: f64 = motion.iter().map(|(_, variance)| 1.0 / variance).sum();
            let mean = motion.iter().map(|(value, variance)| value / variance).sum::<f64>() / information;
            squares += motion.iter().map(|(value, variance)| (value - mean).powi(2) / variance).sum::<f64>();
            means.push((mean, information));
        }
        let within = (squares / windows.saturating_sub(means.len()).max(1) as f64).max(1.0);
        let sum: f64 = means.iter().map(|(_, i)| i).sum();
        let mean = means.iter().map(|(m, i)| m * i).sum::<f64>() / sum;
        let freedom = means.len().saturating_sub(1).max(1) as f64;
        Self {
            windows,
            between: means.iter().map(|(m, i)| i * (m - mean).powi(2)).sum::<f64>() / within,
            information: (sum - means.iter().map(|(_, i)| i * i).sum::<f64>() / sum) / freedom,
            motions: means,
            within,
        }
    }

    fn freedom(&self) -> f64 {
        self.motions.len().saturating_sub(1) as f64
    }

    /// τ² for a value of F.
    fn variance_between(&self, ratio: f64) -> f64 {
        if self.motions.len() < 2 { 0.0 } else { (ratio - 1.0).max(0.0) * self.within / self.information }
    }
}

impl Baseline {
    /// Learns from windows of the unchanged machine, motion by motion; `groups[k]` is what parameter k belongs to.
    ///
    /// # Errors
    /// [`CalibrationError::TooFewWindows`] if no parameter is determined by [`MIN_WINDOWS`] of them.
    pub fn learn(motions: &[Vec<Solution>], groups: &[DriftGroup]) -> Result<Self, CalibrationError> {
        let known = |k: usize| -> Vec<Vec<(f64, f64)>> {
            motions.iter().map(|m| m.iter().filter_map(|w| with_variance(w, k)).collect()).collect()
        };
        let known: Vec<Vec<Vec<(f64, f64)>>> = (0..groups.len()).map(known).collect();
        let spreads: Vec<Spread> = known.iter().map(|k| Spread::of(k)).collect();
        if !spreads.iter().any(|s| s.windows >= MIN_WINDOWS) {
            let found = motions.iter().map(Vec::len).sum();
            return Err(CalibrationError::TooFewWindows { found, needed: MIN_WINDOWS });
        }
        let mut baseline = Self {
            windows: spreads.iter().map(|s| s.windows).collect(),
            motions: spreads.iter().map(|s| s.motions.len()).collect(),
            mean: Vec::new(),
            inflation: spreads.iter().map(|s| s.within.sqrt()).collect(),
            between_motions: Vec::new(),
            between_motions_most: Vec::new(),
            memory: memory(&series(&known, &spreads)),
            variance_of_mean: Vec::new(),
            variance_of_window: Vec::new(),
        };
        for (spread, group) in spreads.iter().zip(groups) {
            let alike = spreads.iter().zip(groups).filter(|(s, g)| *g == group && s.windows >= MIN_WINDOWS);
            let (sum, freedom) =
                alike.fold((0.0, 0.0), |(sum, freedom), (s, _)| (sum + s.between, freedom + s.freedom()));
            let of_group = if freedom > 0.0 { sum / freedom } else { 1.0 };
            let freedom = FREEDOM_OF_GROUP + spread.freedom();
            let ratio = (FREEDOM_OF_GROUP * of_group + spread.between) / freedom;
            let (own, most) = (
                spread.variance_between(ratio),
                spread.variance_between(ratio * freedom / low_chi_squared(freedom)),
            );
            // Of random effects, the mean weights motions by what they tell of it.
            let weight = |information: f64| 1.0 / (own + spread.within * baseline.memory / information);
            let sum: f64 = spread.motions.iter().map(|(_, i)| weight(*i)).sum();
            baseline.mean.push(spread.motions.iter().map(|(m, i)| m * weight(*i)).sum::<f64>() / sum);
            baseline.variance_of_mean.push(1.0 / sum);
            baseline.between_motions.push(own.sqrt());
            baseline.between_motions_most.push(most.sqrt());
            let information: f64 = spread.motions.iter().map(|(_, i)| i).sum();
            baseline
                .variance_of_window
                .push(spread.within * baseline.memory * spread.windows as f64 / information);
        }
        Ok(baseline)
    }

    /// What the rows of a recording say of a parameter; nothing where they or the baseline's do not determine it.
    #[must_use]
    pub fn drift(&self, solution: &Solution, parameter: usize) -> Drift {
        let Some((value, variance)) = self.observed(solution, parameter) else {
            return Drift { value: None, interval_95: None };
        };
        let effect = self.between_motions[parameter].powi(2);
        // Degrees of freedom of the sum of both variances (Welch 1947).
        let of_motions = FREEDOM_OF_GROUP + self.motions[parameter].saturating_sub(1) as f64;
        let own = effect * effect / of_motions + variance * variance / self.freedom_of_windows(parameter);
        let half = (effect + variance + self.variance_of_mean[parameter]).sqrt()
            * student(NORMAL_95, (effect + variance).powi(2) / own);
        Drift { value: Some(value), interval_95: Some([value - half, value + half]) }
    }

    /// δ − m of some rows, and the variance of noise and misfit within a motion, c² L s².
    pub(super) fn observed(&self, solution: &Solution, parameter: usize) -> Option<(f64, f64)> {
        let (value, variance) =
            with_variance(solution, parameter).filter(|_| self.windows[parameter] >= MIN_WINDOWS)?;
        let within = self.inflation[parameter].powi(2) * self.memory * variance;
        Some((value - self.mean[parameter], within))
    }

    /// Degrees of freedom of the variance within motions, N − R.
    pub(super) fn freedom_of_windows(&self, parameter: usize) -> f64 {
        self.windows[parameter].saturating_sub(self.motions[parameter]).max(1) as f64
    }

    /// How far m may be off, at two standard deviations.
    pub(super) fn mean_error(&self, parameter: usize) -> f64 {
        2.0 * self.variance_of_mean[parameter].sqrt()
    }

    /// Deviation of a window of a motion that is not known.
    pub(super) fn deviation(&self, parameter: usize) -> f64 {
        (self.between_motions_most[parameter].powi(2) + self.variance_of_window[parameter]).sqrt()
    }
}

/// Deviations from the mean of each motion, of each parameter that is known well enough.
fn series(known: &[Vec<Vec<(f64, f64)>>], spreads: &[Spread]) -> Vec<Vec<f64>> {
    let mut series = Vec::new();
    for (motions, spread) in known.iter().zip(spreads).filter(|(_, s)| s.windows >= MIN_WINDOWS) {
        let told = motions.iter().filter(|m| !m.is_empty());
        for (motion, (mean, _)) in told.zip(&spread.motions) {
            series.push(motion.iter().map(|(value, variance)| (value - mean) / variance.sqrt()).collect());
        }
    }
    series
}

/// L of some series of deviations from their means.
fn memory(series: &[Vec<f64>]) -> f64 {
    let longest = series.iter().map(Vec::len).max().unwrap_or(0);
    let lags = LAGS.min(longest / 4);
    let series: Vec<&Vec<f64>> = series.iter().filter(|z| z.len() > 2 * lags).collect();
    let correlation = |lag: usize| -> f64 {
        let of = |z: &&Vec<f64>| {
            let power: f64 = z.iter().map(|z| z * z).sum();
            let product: f64 = z.iter().zip(z.iter().skip(lag)).map(|(a, b)| a * b).sum();
            // Taking away the mean lowers the correlation by about one part in as many windows as there are.
            (if power > 0.0 { product / power } else { 0.0 }) + 1.0 / z.len() as f64
        };
        series.iter().map(of).sum::<f64>() / series.len().max(1) as f64
    };
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
    use crate::random::Random;

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
        let spread = |by: f64| -> [Vec<Solution>; 1] {
            [(0..10).map(|i| window(1.0 + by * f64::from(i % 2 * 2 - 1), 0.1)).collect()]
        };
        let learn = |windows: &[Vec<Solution>]| Baseline::learn(windows, &[DriftGroup::Friction]);
        let narrow = learn(&spread(0.0)).unwrap().drift(&window(1.5, 0.1), 0);
        let wide = learn(&spread(0.5)).unwrap().drift(&window(1.5, 0.1), 0);
        assert!((narrow.value.unwrap() - 0.5).abs() < 1e-12);
        assert!(narrow.interval_95.unwrap()[0] > 0.0 && wide.interval_95.unwrap()[0] < 0.0);
        let too_few = learn(&[spread(0.1)[0][..5].to_vec()]).unwrap_err();
        assert!(matches!(too_few, CalibrationError::TooFewWindows { found: 5, .. }));
    }

    /// Motions that differ by 0.3 where windows differ by 0.1.
    #[test]
    fn the_spread_between_motions_is_found_and_one_of_the_group_is_not_taken_for_none() {
        let mut random = Random::new(4);
        let motions: Vec<Vec<Solution>> = (0..30)
            .map(|_| {
                let effect = 0.3 * random.normal();
                (0..20).map(|_| window(effect + 0.1 * random.normal(), 0.1)).collect()
            })
            .collect();
        let many = Baseline::learn(&motions, &[DriftGroup::Gain]).unwrap();
        assert!((many.between_motions[0] / 0.3 - 1.0).abs() < 0.2, "{:?}", many.between_motions);
        let few = Baseline::learn(&motions[..3], &[DriftGroup::Gain]).unwrap();
        assert!(few.between_motions_most[0] > 1.2 * few.between_motions[0]);
        assert!(many.between_motions_most[0] < 1.15 * many.between_motions[0]);
        let one = Baseline::learn(&motions[..1], &[DriftGroup::Gain]).unwrap();
        assert_eq!(one.between_motions, [0.0]);
    }
}
