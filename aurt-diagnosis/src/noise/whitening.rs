//! A filter that makes noise of a known spectrum white.

/// Points of the integrals that turn a spectrum into a correlation.
const POINTS: usize = 1024;
/// White noise added to the spectrum, as a share of its power: where a spectrum falls to nothing, its inverse has
/// nothing to rely on.
const LEAST: f64 = 1e-6;

/// Linear prediction of all orders up to one from a spectrum: row k less what noise lets expect from the rows before,
/// over the standard deviation of that error. Noise of the spectrum becomes white, with variance one, from the first
/// row of each stretch on (the inverse Cholesky factor of its covariance; Durbin 1960). Measurement and columns are to
/// pass the same filter.
#[derive(Debug, Clone, PartialEq)]
pub struct Whitening {
    /// `[order][lag − 1]`.
    predictors: Vec<Vec<f64>>,
    /// Standard deviation of the prediction's error, by order.
    deviations: Vec<f64>,
}

impl Whitening {
    /// From a one-sided spectrum (unit²/Hz) of rows at `rate_hz`, with `order` rows of memory. `None` for a spectrum
    /// without power.
    #[must_use]
    pub fn of(psd: impl Fn(f64) -> f64, rate_hz: f64, order: usize) -> Option<Self> {
        let width_hz = 0.5 * rate_hz / POINTS as f64;
        let powers: Vec<f64> = (0..POINTS).map(|k| psd((k as f64 + 0.5) * width_hz) * width_hz).collect();
        let correlation: Vec<f64> = (0..=order)
            .map(|lag| {
                let turn = std::f64::consts::PI * lag as f64 / POINTS as f64;
                powers.iter().enumerate().map(|(k, p)| p * (turn * (k as f64 + 0.5)).cos()).sum()
            })
            .collect();
        let mut error = correlation[0] * (1.0 + LEAST);
        if !(error.is_finite() && error > 0.0) {
            return None;
        }
        let mut predictors = vec![Vec::new()];
        let mut deviations = vec![error.sqrt()];
        for m in 1..=order {
            let last = &predictors[m - 1];
            let expected: f64 = last.iter().enumerate().map(|(i, a)| a * correlation[m - 1 - i]).sum();
            let reflection = (correlation[m] - expected) / error;
            let mut next: Vec<f64> = (0..m - 1).map(|i| last[i] - reflection * last[m - 2 - i]).collect();
            next.push(reflection);
            error *= 1.0 - reflection * reflection;
            if error <= 0.0 {
                break;
            }
            predictors.push(next);
            deviations.push(error.sqrt());
        }
        Some(Self { predictors, deviations })
    }

    /// Whitens a column of rows. Rows before a segment's start or before a row that does not count have no part in what
    /// follows; rows that do not count stay zero.
    #[must_use]
    pub fn whiten(&self, column: &[f64], segment_starts: &[usize], counts: &[bool]) -> Vec<f64> {
        let mut before = 0;
        column
            .iter()
            .enumerate()
            .map(|(k, value)| {
                if segment_starts.contains(&k) {
                    before = 0;
                }
                if !counts[k] {
                    before = 0;
                    return 0.0;
                }
                let order = before.min(self.predictors.len() - 1);
                before += 1;
                let expected: f64 =
                    self.predictors[order].iter().enumerate().map(|(i, a)| a * column[k - 1 - i]).sum();
                (value - expected) / self.deviations[order]
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use aurt_recording::WhiteAndMarkov;

    use super::Whitening;

    fn noise(truth: &WhiteAndMarkov, count: usize) -> Vec<f64> {
        let mut seed = 17_u64;
        let mut normal = || {
            (0..12)
                .map(|_| {
                    seed =
                        seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                    (seed >> 11) as f64 / (1_u64 << 53) as f64
                })
                .sum::<f64>()
                - 6.0
        };
        let a = (-std::f64::consts::TAU * truth.corner_hz / truth.rate_hz).exp();
        let mut state = truth.markov_std * normal();
        (0..count)
            .map(|_| {
                state = a * state + truth.markov_std * (1.0 - a * a).sqrt() * normal();
                state + truth.white_std * normal()
            })
            .collect()
    }

    #[test]
    fn noise_with_memory_becomes_white() {
        let truth = WhiteAndMarkov { white_std: 0.2, markov_std: 1.0, corner_hz: 2.0, rate_hz: 50.0 };
        let whitening = Whitening::of(|f| truth.psd(f), 50.0, 8).unwrap();
        let rows = noise(&truth, 20_000);
        let counts: Vec<bool> = (0..rows.len()).map(|k| k % 500 > 3).collect();
        let white = whitening.whiten(&rows, &[0, 777, rows.len()], &counts);
        let counted = counts.iter().filter(|c| **c).count() as f64;
        let power = white.iter().map(|w| w * w).sum::<f64>() / counted;
        assert!((power - 1.0).abs() < 0.04, "{power}");
        for lag in 1..6 {
            let product: f64 = white.iter().zip(&white[lag..]).map(|(a, b)| a * b).sum();
            assert!((product / counted / power).abs() < 0.025, "lag {lag}: {}", product / counted);
        }
        assert!(white.iter().zip(&counts).all(|(w, c)| *c || *w == 0.0));
    }

    #[test]
    fn nothing_cannot_be_whitened() {
        assert_eq!(Whitening::of(|_| 0.0, 50.0, 4), None);
    }
}
