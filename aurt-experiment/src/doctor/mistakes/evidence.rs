//! How sure it is that another setup explains the held-out data better than the one that is there.

use aurt_calibration::two_sided;
use serde::Serialize;

use super::trial::Score;

/// Right setups that are accused, at most.
const FALSE_ACCUSATIONS: f64 = 0.005;
/// Searches that can accuse a right setup: of the whole setup, of one recording, of another robot.
pub const TESTS: usize = 3;
/// Gain from which on a setup is told. What the model leaves out makes some wrong setups surely better than the right one, but
/// by less (docs/mistakes.md).
const LEAST_GAIN: f64 = 1.0;

/// Vuong's comparison (1989, *Econometrica* 57) of two setups that are fitted to the same rows and judged on others.
///
/// The likelihood of a row, with a relative deviation r_j of its own for each joint, is ℓ = Σ_j −ln r_j − e_j²/(2σ_j²) + 1/2. What
/// one setup has more of it than the other is averaged over batches: √n batches of √n rows each, since neighbouring rows err
/// alike. Where the other setup is no better but for what no setup models, the mean over its standard error is Student's t.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Evidence {
    /// Mean over rows of the logarithm of the likelihood ratio: Σ_j ln(r_j before / r_j after).
    pub gain: f64,
    pub deviation: f64,
    pub batches: usize,
}

impl Evidence {
    /// What tells setups from those before, both judged on the same parts of recordings; without a fit before, nothing was
    /// explained.
    pub fn of<'s>(pairs: impl IntoIterator<Item = (Option<&'s Score>, &'s Score)>) -> Option<Self> {
        let mut differences = Vec::new();
        for (before, after) in pairs {
            for (k, part) in after.parts.iter().enumerate() {
                let rows = part.first().map_or(0, Vec::len);
                let batches = rows.isqrt();
                let own = after.likelihoods(k, batches);
                let others = before.map_or_else(|| vec![0.0; batches], |b| b.likelihoods(k, batches));
                differences.extend(own.iter().zip(others).map(|(a, b)| a - b));
            }
        }
        let batches = differences.len();
        let n = batches as f64;
        let gain = differences.iter().sum::<f64>() / n;
        let variance = differences.iter().map(|d| (d - gain).powi(2)).sum::<f64>() / (n - 1.0);
        let deviation = (variance / n).sqrt();
        deviation.is_finite().then_some(Self { gain, deviation, batches })
    }

    #[must_use]
    pub fn reversed(self) -> Self {
        Self { gain: -self.gain, ..self }
    }

    /// Whether it is more than chance, and more than what a model leaves out makes up for.
    pub fn is_enough(&self) -> bool {
        self.gain >= LEAST_GAIN && self.is_sure(1)
    }

    /// Whether the gain is more than chance, if it is the best of so many.
    pub fn is_sure(&self, of: usize) -> bool {
        let t = self.gain / self.deviation;
        let probability = 0.5 * two_sided(t, self.batches as f64 - 1.0);
        t > 0.0 && probability * (of as f64) < FALSE_ACCUSATIONS
    }
}

#[cfg(test)]
mod tests {
    use aurt_simulation::Random;

    use super::*;

    /// A score of one joint with errors that follow x_k = ρ x_(k−1) + √(1 − ρ²) w_k, of a measurement of 1.
    fn score(deviation: f64, memory: f64, random: &mut Random) -> Score {
        let mut error = random.normal();
        let rows: Vec<Option<[f64; 2]>> = (0..400)
            .map(|_| {
                error = memory * error + (1.0 - memory * memory).sqrt() * random.normal();
                Some([deviation * error, 1.0])
            })
            .collect();
        let square: f64 = rows.iter().flatten().map(|[e, _]| e * e).sum();
        let joints = vec![Some((square / 400.0).sqrt())];
        let total = joints[0].unwrap_or_default();
        Score { joints, moving: vec![true], fed: vec![false], total, parts: vec![vec![rows]] }
    }

    /// Two setups that are equally good: the test says otherwise in about as many cases as it states, with errors that have a
    /// memory of a few rows too.
    #[test]
    fn equal_setups_are_told_apart_as_often_as_stated() {
        let mut random = Random::new(7);
        for memory in [0.0, 0.5] {
            let wrong = (0..2000)
                .filter(|_| {
                    let [a, b] = [0.3, 0.3].map(|deviation| score(deviation, memory, &mut random));
                    Evidence::of([(Some(&a), &b)]).is_some_and(|e| e.is_sure(1))
                })
                .count();
            assert!(wrong <= 20, "{wrong} of 2000 with a memory of {memory}");
        }
    }

    /// Errors of two joints before and after: a cure lowers those of its own joint, taking that joint out lowers the other's.
    #[test]
    fn a_cure_lowers_the_errors_of_its_own_joints() {
        let of = |joints: [f64; 2]| Score {
            joints: joints.map(Some).to_vec(),
            moving: vec![true; 2],
            fed: vec![false; 2],
            total: 0.5,
            parts: Vec::new(),
        };
        let before = of([0.9, 0.2]);
        assert!(of([0.1, 0.1]).is_better_on(&[0], &before));
        assert!(!of([0.9, 0.02]).is_better_on(&[0], &before));
        assert!(!of([0.2, 0.9]).is_better_on(&[1], &before));
        assert!(of([0.9, 0.02]).is_better_on(&[], &before));
    }

    #[test]
    fn the_gain_is_the_logarithm_of_the_ratio_of_errors() {
        let mut random = Random::new(3);
        let [a, b] = [0.6, 0.3].map(|deviation| score(deviation, 0.5, &mut random));
        let evidence = Evidence::of([(Some(&a), &b)]).unwrap();
        assert!((evidence.gain - (a.total / b.total).ln()).abs() < 1e-9, "{evidence:?}");
        assert!(evidence.is_sure(1000) && evidence.batches == 20);
        // Without a fit nothing was explained.
        let alone = Evidence::of([(None, &b)]).unwrap();
        assert!((alone.gain + b.total.ln()).abs() < 1e-9);
    }
}
