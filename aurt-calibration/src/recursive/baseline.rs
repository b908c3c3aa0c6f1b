use serde::Serialize;

use crate::statistics::{low_chi_squared, student};
use crate::uncertainty::NORMAL_95;
use crate::{CalibrationError, Solution};

/// Fewer windows than this do not tell how much an unchanged machine varies.
pub const MIN_WINDOWS: usize = 6;

/// Windows over which the memory of what the model lacks is followed.
const LAGS: usize = 4;

/// As many motions of its own does what all parameters show together count for each of them.
const MOTIONS_OF_ALL: f64 = 8.0;

/// How the drift parameters of an unchanged machine vary from window to window and from motion to motion.
///
/// A window's estimate δ has a formal deviation s ([`super::DriftEstimate`]); what the model lacks adds to it, within a motion and as an
/// effect u of the motion that all its windows share (a recording is a motion),
///
/// δ_ri = u_r + e_ri,  u_r ~ N(0, θ² s_r²),  e_ri ~ N(0, c² L s_ri²),  s_r² = n_r / Σ_i s_ri⁻².
///
/// **Assumption.** What the model lacks falls on all parameters in proportion to their formal deviations: θ and c in these units differ
/// little among parameters. Motions are few, two or three at times, and one parameter's effects of them say next to nothing of θ; all
/// parameters together say something. So each parameter's mean squares are drawn towards the mean of all parameters, as by
/// eight motions more (as Smyth 2004 does with variances of many genes and few arrays).
///
/// With δ_r the mean of motion r weighted by s⁻², over N windows of R motions, c² = Σ_ri ((δ_ri − δ_r)/s_ri)² / (N − R), at least 1, and
/// F = Σ_r δ_r² Σ_i s_ri⁻² / (c² L R) is 1 in the mean without effects of motions and 1 + n θ²/(c² L) with them. A motion is seen here by a
/// calibration to the others; by one to all, a further motion's effects are (R² − 1)/R² times those in square.
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
    /// c.
    pub inflation: Vec<f64>,
    /// θ.
    pub between_motions: Vec<f64>,
    /// What θ is below with 90 % probability.
    pub between_motions_most: Vec<f64>,
    /// L.
    pub memory: f64,
}

/// A drift parameter with what is known of its precision; all `None` where the rows do not determine it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Drift {
    /// Change since the calibration.
    pub value: Option<f64>,
    /// 95 % interval.
    pub interval_95: Option<[f64; 2]>,
}

struct Spread {
    windows: usize,
    /// δ_r and Σ_i s_ri⁻².
    motions: Vec<(f64, f64)>,
    /// Σ_ri ((δ_ri − δ_r)/s_ri)².
    squares: f64,
}

impl Spread {
    fn of(motions: &[Vec<(f64, f64)>]) -> Self {
        let mut spread =
            Self { windows: motions.iter().map(Vec::len).sum(), motions: Vec::new(), squares: 0.0 };
        for motion in motions.iter().filter(|m| !m.is_empty()) {
            let information: f64 = motion.iter().map(|(_, variance)| 1.0 / variance).sum();
            let mean = motion.iter().map(|(value, variance)| value / variance).sum::<f64>() / information;
            spread.squares += motion.iter().map(|(v, variance)| (v - mean).powi(2) / variance).sum::<f64>();
            spread.motions.push((mean, information));
        }
        spread
    }

    /// N − R.
    fn freedom(&self) -> f64 {
        self.windows.saturating_sub(self.motions.len()).max(1) as f64
    }

    /// Mean of δ_r² Σ_i s_ri⁻².
    fn between(&self) -> f64 {
        self.motions.iter().map(|(mean, information)| mean * mean * information).sum::<f64>()
            / self.motions.len().max(1) as f64
    }
}

impl Baseline {
    /// Learns from windows of the unchanged machine, motion by motion, each of which is seen by a calibration to the others.
    ///
    /// # Errors
    /// [`CalibrationError::TooFewWindows`] if no parameter is determined by [`MIN_WINDOWS`] of them.
    pub fn learn(motions: &[Vec<Solution>]) -> Result<Self, CalibrationError> {
        let parameters = motions.iter().flatten().next().map_or(0, |w| w.coefficients.len());
        let known = |k: usize| -> Vec<Vec<(f64, f64)>> {
            motions.iter().map(|m| m.iter().filter_map(|w| with_variance(w, k)).collect()).collect()
        };
        let known: Vec<Vec<Vec<(f64, f64)>>> = (0..parameters).map(known).collect();
        let spreads: Vec<Spread> = known.iter().map(|k| Spread::of(k)).collect();
        let mean_of = |of: &dyn Fn(&Spread) -> f64| {
            let determined: Vec<f64> = spreads.iter().filter(|s| s.windows >= MIN_WINDOWS).map(of).collect();
            determined.iter().sum::<f64>() / determined.len() as f64
        };
        if !spreads.iter().any(|s| s.windows >= MIN_WINDOWS) {
            let found = motions.iter().map(Vec::len).sum();
            return Err(CalibrationError::TooFewWindows { found, needed: MIN_WINDOWS });
        }
        let memory = memory(&series(&known, &spreads));
        let within_of_all = mean_of(&|s| s.squares / s.freedom());
        let within = |s: &Spread| {
            let of_all = freedom_of_all(s.windows, s.motions.len());
            ((s.squares + of_all * within_of_all) / (s.freedom() + of_all)).max(1.0)
        };
        let ratio_of_all = mean_of(&|s| s.between() / (memory * within(s)));
        let mut baseline = Self {
            windows: spreads.iter().map(|s| s.windows).collect(),
            motions: spreads.iter().map(|s| s.motions.len()).collect(),
            inflation: spreads.iter().map(|s| within(s).sqrt()).collect(),
            between_motions: Vec::new(),
            between_motions_most: Vec::new(),
            memory,
        };
        for spread in &spreads {
            let motions = spread.motions.len().max(1) as f64;
            let noise = memory * within(spread);
            let freedom = MOTIONS_OF_ALL + motions;
            let ratio = (MOTIONS_OF_ALL * ratio_of_all + motions * spread.between() / noise) / freedom;
            let of_further = (motions * motions - 1.0) / (motions * motions);
            let windows = (spread.windows as f64 / motions).max(1.0);
            let effect = |ratio: f64| ((ratio - 1.0).max(0.0) * noise / windows * of_further).sqrt();
            baseline.between_motions.push(effect(ratio));
            baseline.between_motions_most.push(effect(ratio * freedom / low_chi_squared(freedom)));
        }
        Ok(baseline)
    }

    /// What the rows of a recording say of a parameter; nothing where they or the baseline's do not determine it. `window_variance`
    /// is the formal variance s² of one of its windows.
    pub fn drift(&self, solution: &Solution, parameter: usize, window_variance: f64) -> Drift {
        let Some((value, within)) = self.observed(solution, parameter) else {
            return Drift { value: None, interval_95: None };
        };
        let effect = self.between_motions[parameter].powi(2) * window_variance;
        // Degrees of freedom of the sum of both variances (Welch 1947).
        let of_motions = MOTIONS_OF_ALL + self.motions[parameter] as f64;
        let own = effect * effect / of_motions + within * within / self.freedom_of_windows(parameter);
        let half = (effect + within).sqrt() * student(NORMAL_95, (effect + within).powi(2) / own);
        Drift { value: Some(value), interval_95: Some([value - half, value + half]) }
    }

    /// δ of some rows, and the variance of noise and misfit within a motion, c² L s².
    pub(super) fn observed(&self, solution: &Solution, parameter: usize) -> Option<(f64, f64)> {
        let known = self.windows.get(parameter).is_some_and(|w| *w >= MIN_WINDOWS);
        let (value, variance) = with_variance(solution, parameter).filter(|_| known)?;
        Some((value, self.noise(parameter) * variance))
    }

    /// c² L.
    pub(super) fn noise(&self, parameter: usize) -> f64 {
        self.inflation[parameter].powi(2) * self.memory
    }

    /// Degrees of freedom of c².
    pub(super) fn freedom_of_windows(&self, parameter: usize) -> f64 {
        let (windows, motions) = (self.windows[parameter], self.motions[parameter]);
        windows.saturating_sub(motions).max(1) as f64 + freedom_of_all(windows, motions)
    }

    /// How far the calibration is off for all motions, at two standard deviations, in deviations of a window.
    pub(super) fn common_error(&self, parameter: usize) -> f64 {
        let (windows, motions) =
            (self.windows[parameter].max(1) as f64, self.motions[parameter].max(1) as f64);
        let of_noise = self.noise(parameter) / windows;
        let of_motions = self.between_motions_most[parameter].powi(2) / motions;
        2.0 * of_noise.max(of_motions).sqrt()
    }
}

/// Degrees of freedom of windows in as many motions as [`MOTIONS_OF_ALL`].
fn freedom_of_all(windows: usize, motions: usize) -> f64 {
    MOTIONS_OF_ALL * windows as f64 / motions.max(1) as f64
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
    use crate::statistics::Random;

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
        let mut random = Random::new(1);
        let mut noise = || random.uniform() - 0.5;
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
            [(0..10).map(|i| window(by * f64::from(i % 2 * 2 - 1), 0.1)).collect()]
        };
        let learn = |windows: &[Vec<Solution>]| Baseline::learn(windows);
        let narrow = learn(&spread(0.0)).unwrap().drift(&window(0.5, 0.1), 0, 0.01);
        let wide = learn(&spread(0.5)).unwrap().drift(&window(0.5, 0.1), 0, 0.01);
        assert_eq!(narrow.value.unwrap(), 0.5);
        assert!(narrow.interval_95.unwrap()[0] > 0.0 && wide.interval_95.unwrap()[0] < 0.0);
        let too_few = learn(&[spread(0.1)[0][..5].to_vec()]).unwrap_err();
        assert!(matches!(too_few, CalibrationError::TooFewWindows { found: 5, .. }));
    }

    /// Motions that differ by three deviations of a window. As seen by a calibration to the others, they differ by R/(R − 1) in square.
    #[test]
    fn the_spread_between_motions_is_found_and_few_motions_are_not_taken_for_many() {
        let mut random = Random::new(4);
        let motions: Vec<Vec<Solution>> = (0..60)
            .map(|_| {
                let effect = 0.3 * random.normal();
                (0..20).map(|_| window(effect + 0.1 * random.normal(), 0.1)).collect()
            })
            .collect();
        let many = Baseline::learn(&motions).unwrap();
        assert!((many.between_motions[0] / 3.0 - 1.0).abs() < 0.2, "{:?}", many.between_motions);
        assert!(many.between_motions_most[0] < 1.15 * many.between_motions[0]);
        let few = Baseline::learn(&motions[..3]).unwrap();
        assert!(few.between_motions_most[0] > 1.3 * few.between_motions[0]);
        let one = Baseline::learn(&motions[..1]).unwrap();
        assert_eq!(one.between_motions, [0.0]);
    }

    /// Of two motions, one parameter's effects happen to be small; those of the other seven tell that they are not.
    #[test]
    fn parameters_tell_one_another_how_much_motions_differ() {
        let with = |effects: [f64; 8], i: i32| Solution {
            coefficients: effects.iter().map(|e| e + f64::from(i % 2 * 2 - 1)).collect(),
            excited: vec![true; 8],
            residual_sum: Vec::new(),
            covariance: (0..64).map(|k| f64::from(u8::from(k % 9 == 0))).collect(),
            condition_number: 1.0,
        };
        let of = |effects: [f64; 8]| {
            let motions =
                [1.0, -1.0].map(|sign| (0..10).map(|i| with(effects.map(|e| sign * e), i)).collect());
            Baseline::learn(&motions).unwrap().between_motions_most[0]
        };
        let (quiet, loud) = (of([0.1; 8]), of([0.1, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0]));
        assert!(quiet < 0.5 && loud > 2.0, "{quiet} {loud}");
    }
}
