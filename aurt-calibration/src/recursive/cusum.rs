use serde::Serialize;

/// A two-sided cumulative sum of standardised values z, which are N(0, 1) while nothing changes (Page 1954):
/// S⁺ ← max(0, S⁺ + z − k), S⁻ ← max(0, S⁻ − z − k), alarm where either exceeds h.
#[derive(Debug, Clone)]
pub struct Cusum {
    allowance: f64,
    threshold: f64,
    sums: [f64; 2],
    started: [usize; 2],
    taken: usize,
}

/// Where a series changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct ChangePoint {
    /// Index of the first value after the change: where the sum last left zero.
    pub since: usize,
    /// Index of the value at which the change was certain enough.
    pub certain_at: usize,
    /// Whether values rose.
    pub rose: bool,
}

impl Cusum {
    /// A chart with allowance k and threshold h, both in standard deviations.
    pub const fn new(allowance: f64, threshold: f64) -> Self {
        Self { allowance, threshold, sums: [0.0; 2], started: [0; 2], taken: 0 }
    }

    /// Values before this index can no longer begin a change.
    pub fn needed_from(&self) -> usize {
        let begun = self.sums.iter().zip(&self.started).filter(|(sum, _)| **sum > 0.0);
        begun.map(|(_, started)| *started).min().unwrap_or(self.taken)
    }

    /// Takes in the next value; after an alarm both sums start again.
    pub fn push(&mut self, z: f64) -> Option<ChangePoint> {
        self.push_weighted(z, self.allowance, 1.0)
    }

    /// As [`Self::push`] with an allowance of its own, and a weight for what exceeds it: with the shift w of z that a
    /// change makes as weight and ½ w as allowance, sums are logarithms of likelihood ratios.
    pub fn push_weighted(&mut self, z: f64, allowance: f64, weight: f64) -> Option<ChangePoint> {
        let at = self.taken;
        self.taken += 1;
        for (side, value) in [z, -z].into_iter().enumerate() {
            if self.sums[side] == 0.0 {
                self.started[side] = at;
            }
            self.sums[side] = (self.sums[side] + weight * (value - allowance)).max(0.0);
        }
        let side = usize::from(self.sums[1] > self.sums[0]);
        if self.sums[side] <= self.threshold {
            return None;
        }
        self.sums = [0.0; 2];
        Some(ChangePoint { since: self.started[side], certain_at: at, rose: side == 0 })
    }
}

/// Mean number of values between two false alarms of a two-sided [`Cusum`] over independent N(0, 1) values, by
/// Siegmund's approximation: ½ (e^{2kb} − 2kb − 1) / (2k²), b = h + 1.166 (Siegmund 1985, *Sequential Analysis*,
/// equation 2.56).
pub fn average_run_length(allowance: f64, threshold: f64) -> f64 {
    let x = 2.0 * allowance * (threshold + 1.166);
    0.5 * (libm::expm1(x) - x) / (2.0 * allowance * allowance)
}

/// The threshold with that [`average_run_length`]; zero where even that gives more.
pub fn threshold_for(allowance: f64, run_length: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    while average_run_length(allowance, high) < run_length {
        high *= 2.0;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if average_run_length(allowance, middle) < run_length {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Independent standard normal numbers, by Box and Muller.
    fn normal(state: &mut u64) -> f64 {
        let mut uniform = || {
            *state ^= *state << 13;
            *state ^= *state >> 7;
            *state ^= *state << 17;
            ((*state >> 11) as f64 + 0.5) / (1u64 << 53) as f64
        };
        let (u, v) = (uniform(), uniform());
        (-2.0 * libm::log(u)).sqrt() * libm::cos(std::f64::consts::TAU * v)
    }

    /// The mean over 3000 runs is known to about 2 %; the approximation is good to a few percent.
    #[test]
    fn false_alarms_on_noise_come_as_seldom_as_stated() {
        let mut state = 0x2545_F491_4F6C_DD1D;
        for (allowance, wanted) in [(0.5, 100.0), (0.5, 500.0), (0.8, 300.0)] {
            let threshold = threshold_for(allowance, wanted);
            assert!((average_run_length(allowance, threshold) / wanted - 1.0).abs() < 1e-9);
            let mut chart = Cusum::new(allowance, threshold);
            let (mut alarms, mut values) = (0, 0);
            while alarms < 3000 {
                values += 1;
                alarms += usize::from(chart.push(normal(&mut state)).is_some());
            }
            let found = f64::from(values) / alarms as f64;
            assert!((found / wanted - 1.0).abs() < 0.08, "k = {allowance}: {found} instead of {wanted}");
        }
    }

    #[test]
    fn a_change_is_dated() {
        let mut state = 7;
        let mut chart = Cusum::new(0.5, threshold_for(0.5, 1e6));
        let found = (0..400).find_map(|i| {
            let shift = if i < 200 { 0.0 } else { -2.0 };
            chart.push(normal(&mut state) + shift)
        });
        let found = found.unwrap();
        assert!(!found.rose && found.since.abs_diff(200) < 6 && found.certain_at < 220, "{found:?}");
    }
}
