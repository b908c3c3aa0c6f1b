//! The white part of a series, beneath its motion.

use crate::noise::median;

/// Orders of the divided differences. White noise has the same level in all of them; of motion a higher order leaves
/// less below a sixth of the sampling rate, and more above it. The least level counts.
const ORDERS: [usize; 3] = [4, 6, 8];

const LONGEST: usize = 9;

/// A higher order must show this much less: two estimates from a hundred chunks differ by some per cent.
const LESS: f64 = 0.93;

/// Differences in one chunk: long enough for a mean square, short enough that an impact affects few chunks.
const CHUNK: usize = 32;

/// Stamps whose distances differ by less than this share are even, and the coefficients of one difference serve all. The
/// rounding of stamps of minutes at 1 kHz is a hundredth of it.
const EVEN: f64 = 1e-9;

/// Neighbouring stamps further apart than this, in median distances, are no neighbours: motion would count.
const FARTHEST: f64 = 3.5;

/// Standard deviation of the white part of a series, from divided differences on its own stamps in s: the
/// coefficients c_i = 1/Π_{k≠i}(t_i − t_k), scaled to Σ c_i² = 1, remove every polynomial below their order from samples
/// at any stamps, so that a clock that jitters and says so is no noise.
///
/// The median of mean squares over chunks of 32 differences is used, so that impacts and reversals do not count;
/// chunks in which nothing changes (a resting joint on the lattice of its encoder) do not count either.
/// 0 where the series is too short.
pub fn white_level_at(time_s: &[f64], series: &[f64]) -> f64 {
    level_and_order(time_s, series).map_or(0.0, |(level, _)| level)
}

/// The level, and the order of the differences that show it; `None` where the series is too short.
pub(super) fn level_and_order(time_s: &[f64], series: &[f64]) -> Option<(f64, usize)> {
    let mut found: Option<(f64, usize)> = None;
    for order in ORDERS {
        let Some(level) = level_of_order(time_s, series, order) else { continue };
        if found.is_none_or(|(least, _)| level < LESS * least) {
            found = Some((level, order));
        }
    }
    found
}

/// The level in divided differences of one order; `None` where there is no chunk of them.
fn level_of_order(time_s: &[f64], series: &[f64], order: usize) -> Option<f64> {
    let mut distances: Vec<f64> = time_s.windows(2).map(|w| w[1] - w[0]).collect();
    if distances.is_empty() {
        return None;
    }
    let usual_s = median(&mut distances);
    let even = distances.iter().all(|d| (d - usual_s).abs() < EVEN * usual_s);
    let all_alike = even.then(|| time_s.get(..=order).map(Coefficients::of)).flatten();
    let mut squares = Vec::with_capacity(CHUNK);
    let mut chunks = Vec::new();
    let mut still = 0;
    for (t, x) in time_s.windows(order + 1).zip(series.windows(order + 1)) {
        let far = |w: &[f64]| w[1] - w[0] <= 0.0 || w[1] - w[0] >= FARTHEST * usual_s;
        if !even && t.windows(2).any(far) {
            squares.clear();
            continue;
        }
        let difference = match &all_alike {
            Some(coefficients) => coefficients.applied(x),
            None => Coefficients::of(t).applied(x),
        };
        squares.push(difference * difference);
        if squares.len() == CHUNK {
            let mean = squares.iter().sum::<f64>() / CHUNK as f64;
            if mean > 0.0 {
                chunks.push(mean)
            } else {
                still += 1
            }
            squares.clear();
        }
    }
    if chunks.is_empty() {
        return (still > 0).then_some(0.0);
    }
    Some((median(&mut chunks) / median_share(order)).sqrt())
}

/// Coefficients of a divided difference, scaled to unit power.
struct Coefficients([f64; LONGEST]);

impl Coefficients {
    fn of(t: &[f64]) -> Self {
        // In units of the first distance, so that products stay near one.
        let per_unit = 1.0 / (t[1] - t[0]);
        let (mut at, mut own) = ([0.0; LONGEST], [0.0; LONGEST]);
        at.iter_mut().zip(t).for_each(|(at, t_s)| *at = (t_s - t[0]) * per_unit);
        let at = &at[..t.len()];
        let mut power = 0.0;
        for (i, (own, own_at)) in own.iter_mut().zip(at).enumerate() {
            let others = at[..i].iter().chain(&at[i + 1..]);
            *own = 1.0 / others.map(|other| own_at - other).product::<f64>();
            power += *own * *own;
        }
        let scale = 1.0 / power.sqrt();
        own.iter_mut().for_each(|c| *c *= scale);
        Self(own)
    }

    /// Σ c_i x_i. The first value is taken off, so that large angles lose no digits.
    fn applied(&self, x: &[f64]) -> f64 {
        self.0.iter().zip(x).map(|(c, x_i)| c * (x_i - x[0])).sum()
    }
}

/// Median over mean of the mean square of a chunk of white noise's differences, which are correlated: with
/// ρ_k = C(2p, p+k)/C(2p, p) a chunk has ν = n / Σ ρ_k² independent values, and the median of χ²_ν/ν is
/// (1 − 2/9ν)³ (Wilson and Hilferty 1931).
fn median_share(order: usize) -> f64 {
    let mut correlation = 1.0;
    let mut squares = 1.0;
    for k in 0..order {
        correlation *= -((order - k) as f64) / (order + k + 1) as f64;
        squares += 2.0 * correlation * correlation;
    }
    let independent = CHUNK as f64 / squares;
    (1.0 - 2.0 / (9.0 * independent)).powi(3)
}

#[cfg(test)]
mod tests {
    use super::white_level_at;
    use crate::noise::Normal;

    #[test]
    fn noise_is_measured_beneath_a_motion() {
        let mut normal = Normal::new(1);
        let time: Vec<f64> = (0..5000).map(f64::from).collect();
        let series: Vec<f64> = time.iter().map(|t| 3.0 * (t * 0.01).sin() + 0.02 * normal.next()).collect();
        let level = white_level_at(&time, &series);
        assert!((level - 0.02).abs() < 0.001, "{level}");
    }

    /// Stamps of 500 Hz that jitter by a share of the period, and an angle at each.
    fn jittering(share: f64, noise: f64) -> (Vec<f64>, Vec<f64>) {
        let mut normal = Normal::new(7);
        let time: Vec<f64> = (0..6000).map(|k| 0.002 * (f64::from(k) + share * normal.next())).collect();
        let angle =
            time.iter().map(|t| 1.2 * (3.0 * t).sin() + 0.4 * (11.0 * t).cos() + noise * normal.next());
        let angle = angle.collect();
        (time, angle)
    }

    #[test]
    fn a_clock_that_jitters_and_says_so_is_no_noise() {
        let (time, angle) = jittering(0.02, 0.0);
        let even: Vec<f64> = (0..time.len()).map(|k| 0.002 * k as f64).collect();
        assert!(white_level_at(&even, &angle) > 1e-5, "the rows alone look noisy");
        assert!(white_level_at(&time, &angle) < 1e-11, "{}", white_level_at(&time, &angle));
    }

    #[test]
    fn noise_is_found_on_stamps_that_jitter() {
        for noise in [1e-6, 1e-5, 1e-4] {
            let (time, angle) = jittering(0.06, noise);
            let ratio = white_level_at(&time, &angle) / noise;
            assert!((0.95..1.05).contains(&ratio), "{noise}: {ratio}");
        }
    }

    #[test]
    fn rest_on_a_lattice_counts_neither_as_nothing_nor_as_noise() {
        let (time, mut angle) = jittering(0.0, 1e-4);
        for value in angle.iter_mut().skip(1000).take(3500) {
            *value = 0.125;
        }
        let level = white_level_at(&time, &angle);
        assert!((level / 1e-4 - 1.0).abs() < 0.08, "{level}");
    }

    #[test]
    fn too_short_a_series_has_no_level() {
        assert_eq!(white_level_at(&[], &[]), 0.0);
        assert_eq!(white_level_at(&[0.0, 0.1, 0.2], &[1.0, 2.0, 0.0]), 0.0);
    }
}
