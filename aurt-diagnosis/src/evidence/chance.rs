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

    /// Location and scale of the best scores on some joints; none of fewer than two. Largest values of many scores have
    /// Gumbel's distribution, which is taken by its moments: a few dozen values have no rare quantile of their own.
    fn gumbel(&self, joints: &[usize]) -> Option<[f64; 2]> {
        let n = self.shifts.len() as f64;
        if n < 2.0 || joints.is_empty() {
            return None;
        }
        let mean = self.on(joints).sum::<f64>() / n;
        let variance = self.on(joints).map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
        let scale = (6.0 * variance).sqrt() / std::f64::consts::PI;
        Some([mean - scale * EULER, scale])
    }

    /// Searches over all of a robot's joints for one over some of them.
    fn searches(&self, joints: &[usize]) -> f64 {
        self.shifts[0].len() as f64 / joints.len() as f64
    }

    /// The score that chance reaches on some joints in the course of a search over all joints with a probability; 0 where
    /// chance was not tried.
    pub fn score(&self, joints: &[usize], probability: f64) -> f64 {
        self.gumbel(joints).map_or(0.0, |[location, scale]| {
            let none = libm::log1p(-probability) / self.searches(joints);
            location - scale * libm::log(-none)
        })
    }

    /// The probability that chance reaches a score on some joints in the course of a search over all joints; none where
    /// chance was not tried.
    pub fn probability(&self, joints: &[usize], score: f64) -> Option<f64> {
        let [location, scale] = self.gumbel(joints)?;
        let tail = if scale > 0.0 {
            libm::exp(-(score - location) / scale)
        } else {
            f64::from(u8::from(score <= location))
        };
        Some(-libm::expm1(-self.searches(joints) * tail))
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
        let [calm, wandering, both] = [&[0][..], &[1], &[0, 1]].map(|joints| chance().score(joints, 0.05));
        assert!(calm < 4.0 && wandering > 15.0, "{calm} {wandering}");
        assert!(both > calm && both <= wandering, "{both}");
        let likely = |joint: usize, score: f64| chance().probability(&[joint], score).unwrap();
        assert!((likely(1, wandering) - 0.05).abs() < 1e-12 && likely(0, wandering) < 1e-6);
        assert!(likely(1, 2.0) > 0.9 && likely(1, 99.0) < 1e-6);
        assert_eq!(Chance::default().probability(&[0], 1.0), None);
        assert_eq!(Chance::default().score(&[0], 0.05), 0.0);
    }

    /// Deviates of Gumbel's distribution with location 3 and scale 2, at evenly spaced probabilities: the 97.5 % quantile
    /// is 3 − 2 ln(−ln 0.975), within what the moments of 200 of them leave.
    #[test]
    fn the_quantile_is_gumbels() {
        let deviate = |k: usize| 3.0 - 2.0 * (-((k as f64 + 0.5) / 200.0).ln()).ln();
        let chance = Chance::new((0..200).map(|k| vec![deviate(k), 0.0]).collect());
        // Of two joints each has the root of the probability that neither is reached.
        let expected = 3.0 - 2.0 * (-(0.95_f64.sqrt().ln())).ln();
        assert!((chance.score(&[0], 0.05) / expected - 1.0).abs() < 0.03);
    }
}
