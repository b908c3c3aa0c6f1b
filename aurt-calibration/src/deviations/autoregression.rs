//! The memory of a residual as an autoregression.

/// e_t = Σ_k a_k e_{t−k} + η_t.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Autoregression {
    /// a_1, a_2, …
    pub coefficients: Vec<f64>,
    /// Variance of η.
    pub innovation: f64,
}

/// No order above this, and none above a twentieth of the number of rows.
const MOST: usize = 16;

/// Autocovariance sums Σ_t e_t e_{t+lag} of stretches without gaps, for lags up to the largest order, and the number of
/// values.
#[derive(Debug, Clone, Default)]
pub(crate) struct Autocovariance {
    sums: Vec<f64>,
    values: usize,
}

impl Autocovariance {
    /// Adds a stretch; values that do not count are zero, and `counted` says how many do.
    pub(crate) fn add(&mut self, stretch: &[f64], counted: usize) {
        self.sums.resize(MOST + 1, 0.0);
        for (lag, sum) in self.sums.iter_mut().enumerate().take(stretch.len()) {
            *sum += stretch.iter().zip(&stretch[lag..]).map(|(a, b)| a * b).sum::<f64>();
        }
        self.values += counted;
    }

    fn variance(&self) -> f64 {
        self.sums.first().map_or(0.0, |s| s / self.values.max(1) as f64)
    }

    /// The autoregression of the order that Akaike's criterion, corrected for small samples (Hurvich, Tsai 1989), prefers;
    /// coefficients by Levinson's recursion.
    pub(crate) fn fit(&self) -> Autoregression {
        let count = self.values as f64;
        let variance = self.variance();
        let mut best = Autoregression { coefficients: Vec::new(), innovation: variance };
        if variance <= 0.0 {
            return best;
        }
        let lag = |k: usize| self.sums[k] / count;
        let criterion = |order: usize, innovation: f64| {
            count * libm::log(innovation) + count * (count + order as f64) / (count - order as f64 - 2.0)
        };
        let mut least = criterion(0, variance);
        let (mut current, mut innovation): (Vec<f64>, f64) = (Vec::new(), variance);
        for order in 1..=MOST.min(self.values / 20) {
            let missed =
                lag(order) - current.iter().enumerate().map(|(k, a)| a * lag(order - 1 - k)).sum::<f64>();
            let reflection = missed / innovation;
            let mut next: Vec<f64> =
                (0..order - 1).map(|k| current[k] - reflection * current[order - 2 - k]).collect();
            next.push(reflection);
            innovation *= 1.0 - reflection * reflection;
            if innovation <= 0.0 || !innovation.is_finite() {
                break;
            }
            current = next;
            let here = criterion(order, innovation);
            if here < least {
                least = here;
                best = Autoregression { coefficients: current.clone(), innovation };
            }
        }
        best
    }
}

impl Autoregression {
    /// Ψᵀ w for the covariance Γ = innovation · Ψ Ψᵀ of the series, so that wᵀ Γ w = innovation · ‖Ψᵀ w‖²: the recursion run
    /// backwards, from the end of `w` and on before its beginning until what remains has faded.
    pub(crate) fn coloured(&self, w: &[f64], out: &mut Vec<f64>) {
        out.clear();
        if self.coefficients.is_empty() {
            out.extend_from_slice(w);
            return;
        }
        let before = FADED * self.coefficients.len();
        out.resize(w.len() + before, 0.0);
        out[before..].copy_from_slice(w);
        for s in (0..out.len()).rev() {
            let after = &out[s + 1..];
            let more: f64 = self.coefficients.iter().zip(after).map(|(a, u)| a * u).sum();
            out[s] += more;
        }
    }

    /// How many values longer a coloured series is.
    pub(crate) fn longer(&self) -> usize {
        FADED * self.coefficients.len()
    }
}

/// Steps beyond the beginning for each order, after which what an autoregression remembers has faded.
const FADED: usize = 12;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::Random;

    fn normal(seed: u64, n: usize) -> Vec<f64> {
        let mut random = Random::new(seed);
        (0..n).map(|_| random.normal()).collect()
    }

    #[test]
    fn a_known_autoregression_is_found_and_so_is_white_noise() {
        let mut series = normal(3, 20_000);
        for t in 2..series.len() {
            series[t] += 1.2 * series[t - 1] - 0.5 * series[t - 2];
        }
        let mut covariance = Autocovariance::default();
        covariance.add(&series, series.len());
        let found = covariance.fit();
        assert!(
            (found.coefficients[0] - 1.2).abs() < 0.05 && (found.coefficients[1] + 0.5).abs() < 0.05,
            "{found:?}"
        );
        assert!((found.innovation - 1.0).abs() < 0.03, "{found:?}");
        let white = normal(5, 20_000);
        let mut covariance = Autocovariance::default();
        covariance.add(&white, white.len());
        assert!(covariance.fit().coefficients.iter().all(|a| a.abs() < 0.03));
    }

    #[test]
    fn coloured_columns_give_the_variance_of_a_sum() {
        // Var Σ e_t of an autoregression of order one, a = 0.6, over n values: (n + 2 Σ (n − k) a^k) / (1 − a²).
        let model = Autoregression { coefficients: vec![0.6], innovation: 1.0 };
        let n = 50;
        let expected = (n as f64
            + 2.0 * (1..n).map(|k| (n - k) as f64 * 0.6_f64.powi(k as i32)).sum::<f64>())
            / (1.0 - 0.36);
        let mut out = Vec::new();
        model.coloured(&vec![1.0; n], &mut out);
        let found: f64 = out.iter().map(|v| v * v).sum();
        assert!((found / expected - 1.0).abs() < 1e-4, "{found} {expected}");
        assert_eq!(out.len(), n + model.longer());
    }
}
