use super::{Baseline, ChangePoint, Cusum, MIN_WINDOWS};
use crate::Solution;
use crate::statistics::normal;

/// A parameter's chart: three CUSUMs over windows that share what the model lacks on their motion.
///
/// Window i of a motion shows d_i = u + e_i, e_i ~ N(0, v_i), v_i = c² L s_i². The effect of the motion is u ~ N(0, θ² s²) with s² the harmonic mean of
/// s_i² so far. Given the windows before, u has the mean û_i and the variance P_i; innovations ε_i = (d_i − û_i)/√S_i, S_i = P_i + v_i, are
/// independent N(0, 1) while nothing changes, where the windows themselves are not. A shift b that is there from the motion's beginning
/// on moves ε_i by g_i b; g_i falls from window to window, since the shift is taken for the motion.
///
/// *Sudden* sums ε_i with an allowance of ½, for changes within a motion. *Lasting* sums w_i (ε_i − ½ w_i), w_i = g_i b₁, the
/// logarithm of the likelihood ratio of the shift b₁, over all motions, for b₁ of one deviation of a window, where motions do not
/// differ the same as *sudden*, and of four, for shifts that stand out of the motions at once. What the calibration may be off by on all motions, at two
/// deviations, comes back in every window and is allowed in all of them.
#[derive(Debug, Clone)]
pub struct Chart {
    /// Which parameter.
    pub parameter: usize,
    sudden: Cusum,
    lasting: [Cusum; LASTING.len()],
    motion: Motion,
}

/// Windows of a motion so far.
#[derive(Debug, Clone, Copy, Default)]
struct Motion {
    windows: f64,
    /// Σ s_i⁻².
    information: f64,
    /// Σ d_i s_i⁻².
    sum: f64,
}

/// Shifts b₁, in deviations of a window.
const LASTING: [f64; 2] = [1.0, 4.0];

impl Chart {
    /// CUSUMs per chart.
    pub const SUMS: usize = 1 + LASTING.len();
    /// k, in deviations of an innovation.
    pub const ALLOWANCE: f64 = 0.5;

    /// A chart of a parameter with the threshold h; nothing where the baseline does not determine it.
    pub fn new(parameter: usize, baseline: &Baseline, threshold: f64) -> Option<Self> {
        let cusum = Cusum::new(Self::ALLOWANCE, threshold);
        let chart = Self {
            parameter,
            sudden: cusum.clone(),
            lasting: [cusum.clone(), cusum],
            motion: Motion::default(),
        };
        (baseline.windows[parameter] >= MIN_WINDOWS).then_some(chart)
    }

    /// The windows that follow are of another motion.
    pub fn begin_motion(&mut self) {
        self.motion = Motion::default();
    }

    /// Windows before this index can no longer begin a change.
    pub fn needed_from(&self) -> usize {
        self.lasting.iter().fold(self.sudden.needed_from(), |first, c| first.min(c.needed_from()))
    }

    /// Takes in the next window, if its rows determine the parameter: whether they do, and the change that it makes certain.
    pub fn push(&mut self, baseline: &Baseline, window: &Solution) -> (bool, Option<ChangePoint>) {
        let Some((drift, within)) = baseline.observed(window, self.parameter) else { return (false, None) };
        let noise = baseline.noise(self.parameter);
        let (known, information) = (self.motion.information, noise / within);
        self.motion.windows += 1.0;
        let variance = self.motion.windows / (known + information);
        let effect = baseline.between_motions_most[self.parameter].powi(2) * variance;
        // P, û, and what û takes up of a shift of 1.
        let left = 1.0 / (1.0 / effect + known / noise);
        let (expected, taken_up) = (left * self.motion.sum / noise, left * known / noise);
        let deviation = (left + within).sqrt();
        let innovation = normal((drift - expected) / deviation, baseline.freedom_of_windows(self.parameter));
        self.motion.information += information;
        self.motion.sum += drift * information;

        let response = (1.0 - taken_up) / deviation;
        let of_all = response * baseline.common_error(self.parameter) * variance.sqrt();
        let mut change = self.sudden.push_weighted(innovation, Self::ALLOWANCE + of_all, 1.0);
        for (cusum, deviations) in self.lasting.iter_mut().zip(LASTING) {
            let shift = deviations * response * (effect + noise * variance).sqrt();
            let found = cusum.push_weighted(innovation, 0.5 * shift + of_all, shift);
            change = found.or(change);
        }
        (true, change)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recursive::threshold_for;
    use crate::statistics::Random;

    fn window(value: f64) -> Solution {
        Solution {
            coefficients: vec![value],
            excited: vec![true],
            residual_sum: Vec::new(),
            covariance: vec![1.0],
            condition_number: 1.0,
        }
    }

    /// Motions of twelve windows whose effects have the deviation τ, that of a window within its motion being 1; `shift` is added
    /// from motion `from` on.
    fn motion(random: &mut Random, between: f64, shift: f64) -> Vec<Solution> {
        let effect = between * random.normal();
        (0..12).map(|_| window(effect + shift + random.normal())).collect()
    }

    fn alarms(chart: &mut Chart, baseline: &Baseline, windows: &[Solution]) -> usize {
        chart.begin_motion();
        windows.iter().filter(|w| chart.push(baseline, w).1.is_some()).count()
    }

    /// A rate of one in 600 windows for either CUSUM, over 3 × 20 000 motions of 12 windows; baselines of 200 motions, that the
    /// spread is known.
    #[test]
    fn motions_that_differ_raise_no_more_false_alarms_than_stated() {
        for between in [0.0, 0.4, 1.5] {
            let mut random = Random::new(11);
            let known: Vec<Vec<Solution>> = (0..200).map(|_| motion(&mut random, between, 0.0)).collect();
            let baseline = Baseline::learn(&known).unwrap();
            let mut chart = Chart::new(0, &baseline, threshold_for(Chart::ALLOWANCE, 600.0)).unwrap();
            let found: usize =
                (0..20_000).map(|_| alarms(&mut chart, &baseline, &motion(&mut random, between, 0.0))).sum();
            let stated = 12.0 * 20_000.0 * Chart::SUMS as f64 / 600.0;
            assert!(found > 0 && (found as f64) < stated, "{between}: {found}, {stated}");
        }
    }

    /// A shift of three deviations between motions is seen over some motions, one of sixteen in the first, one within a motion as
    /// soon as without effects of motions.
    #[test]
    fn shifts_are_found_beside_motions_that_differ() {
        let mut random = Random::new(5);
        let known: Vec<Vec<Solution>> = (0..60).map(|_| motion(&mut random, 0.5, 0.0)).collect();
        let baseline = Baseline::learn(&known).unwrap();
        let threshold = threshold_for(Chart::ALLOWANCE, 1e6);
        let delay = |shift: f64, random: &mut Random| {
            let mut chart = Chart::new(0, &baseline, threshold).unwrap();
            (1..200).find(|_| alarms(&mut chart, &baseline, &motion(random, 0.5, shift)) > 0)
        };
        let (small, large) = (delay(1.5, &mut random), delay(8.0, &mut random));
        assert!(small.unwrap() < 12 && large == Some(1), "{small:?} {large:?}");
        let mut chart = Chart::new(0, &baseline, threshold).unwrap();
        let quiet: Vec<Solution> = (0..300).map(|_| window(random.normal())).collect();
        assert!(!quiet.iter().any(|w| chart.push(&baseline, w).1.is_some()));
        let late = (1..100).find(|_| chart.push(&baseline, &window(2.0 + random.normal())).1.is_some());
        assert!(late.unwrap() < 16, "{late:?}");
    }
}
