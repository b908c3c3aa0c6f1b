//! What chance reaches, joint by joint.

/// The best scores that chance reaches, of one shift of the residual each, `[shift][joint]`: over all hypotheses that
/// concern the joint. A joint whose residual wanders makes chance do well there, and says nothing of the others.
#[derive(Debug, Clone, Default)]
pub struct Chance {
    shifts: Vec<Vec<f64>>,
}

/// Euler's constant: the mean of Gumbel's distribution over its scale.
const EULER: f64 = 0.577_215_664_901_532_9;

impl Chance {
    pub(crate) const fn new(shifts: Vec<Vec<f64>>) -> Self {
        Self { shifts }
    }

    /// The best score of each shift on some joints.
    fn on(&self, joints: &[usize]) -> impl Iterator<Item = f64> {
        self.shifts.iter().map(|best| joints.iter().map(|j| best[*j]).fold(0.0, f64::max))
    }

    /// The score that the best hypothesis on some of a robot's joints exceeds by chance so rarely that one search over
    /// all joints in 1 / (1 − `quantile`) has a finding; 0 where there are no shifts. Largest values of many scores have
    /// Gumbel's distribution, which is taken by its moments: a few dozen values have no such quantile of their own.
    #[must_use]
    pub fn threshold(&self, joints: &[usize], quantile: f64) -> f64 {
        let n = self.shifts.len() as f64;
        if n < 2.0 || joints.is_empty() {
            return self.on(joints).fold(0.0, f64::max);
        }
        let mean = self.on(joints).sum::<f64>() / n;
        let variance = self.on(joints).map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
        let scale = (6.0 * variance).sqrt() / std::f64::consts::PI;
        let rarely = (1.0 - quantile) * joints.len() as f64 / self.shifts[0].len() as f64;
        mean - scale * (EULER + libm::log(-libm::log1p(-rarely)))
    }

    /// The probability that chance reaches a score on some joints: (1 + times it did) / (1 + times it was tried); none
    /// where it was not tried.
    #[must_use]
    pub fn probability(&self, joints: &[usize], score: f64) -> Option<f64> {
        let reached = self.on(joints).filter(|best| *best >= score).count();
        (!self.shifts.is_empty()).then(|| (1 + reached) as f64 / (1 + self.shifts.len()) as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two joints, of which the second wanders.
    fn chance() -> Chance {
        Chance::new([[0.0, 4.0], [1.0, 9.0], [2.0, 2.0], [1.0, 15.0], [0.5, 6.0]].map(Vec::from).to_vec())
    }

    #[test]
    fn a_joint_that_wanders_says_nothing_of_the_others() {
        let [calm, wandering, both] =
            [&[0][..], &[1], &[0, 1]].map(|joints| chance().threshold(joints, 0.95));
        assert!(calm < 4.0 && wandering > 15.0, "{calm} {wandering}");
        assert!(both > calm && both <= wandering, "{both}");
        assert_eq!(chance().probability(&[0], 2.0), Some(2.0 / 6.0));
        assert_eq!(chance().probability(&[1], 99.0), Some(1.0 / 6.0));
        assert_eq!(Chance::default().probability(&[0], 1.0), None);
        assert_eq!(Chance::default().threshold(&[0], 0.95), 0.0);
    }

    /// Deviates of Gumbel's distribution with location 3 and scale 2, at evenly spaced probabilities: the 97.5 % quantile
    /// is 3 − 2 ln(−ln 0.975), within what the moments of 200 of them leave.
    #[test]
    fn the_quantile_is_gumbels() {
        let deviate = |k: usize| 3.0 - 2.0 * (-((k as f64 + 0.5) / 200.0).ln()).ln();
        let chance = Chance::new((0..200).map(|k| vec![deviate(k), 0.0]).collect());
        let expected = 3.0 - 2.0 * (-(0.975_f64.ln())).ln();
        assert!((chance.threshold(&[0], 0.95) / expected - 1.0).abs() < 0.03);
    }
}
