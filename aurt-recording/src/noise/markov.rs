//! White noise and noise with memory: their fit to a spectrum.

use super::spectrum::SpectrumBand;

/// White noise, and a first-order Gauss–Markov process x_{k+1} = a x_k + …, a = e^{−2π f_c/rate}.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WhiteAndMarkov {
    /// Standard deviation of the white part.
    pub white_std: f64,
    /// Standard deviation of the part with memory; 0 for none.
    pub markov_std: f64,
    /// f_c of the part with memory, Hz.
    pub corner_hz: f64,
    /// Samples per second.
    pub rate_hz: f64,
}

/// Corners that are tried, as shares of the sampling rate: between them the spectrum differs by less than it scatters.
const LOWEST_CORNER: f64 = 5e-4;
const HIGHEST_CORNER: f64 = 0.2;
const CORNERS: usize = 40;
/// Rounds of reweighting; the powers settle within a few.
const ROUNDS: usize = 12;
/// Gain of log-likelihood that memory must bring: two parameters at ½ ln n each by Schwarz's criterion, n ≤ 400 bands
/// and values, say 2·3.
const MEMORY_BRINGS: f64 = 6.0;
/// A band that exceeds the fit by this factor holds something else than noise and weighs less.
const TOO_MUCH: f64 = 1.5;
/// Neighbouring values of half-overlapping windowed pieces and their median carry about this share of independent ones.
const INDEPENDENT: f64 = 0.4;

impl WhiteAndMarkov {
    /// White noise alone.
    pub const fn white(white_std: f64, rate_hz: f64) -> Self {
        Self { white_std, markov_std: 0.0, corner_hz: 0.0, rate_hz }
    }

    /// One-sided power spectrum, unit²/Hz: 2σ_w²/rate + (2σ²/rate)(1−a²)/(1 − 2a cos ω + a²).
    pub fn psd(&self, frequency_hz: f64) -> f64 {
        let white = 2.0 * self.white_std * self.white_std / self.rate_hz;
        if self.markov_std == 0.0 {
            return white;
        }
        white + self.markov_std * self.markov_std * markov_shape(frequency_hz, self.corner_hz, self.rate_hz)
    }

    /// Fits both powers and the corner to a spectrum by Whittle's likelihood Σ n (ln S + Ŝ/S), with S the sum of the
    /// noise times `gain(f)` (what interpolation left of it) and of what is known to be there beside, `known(f)`.
    ///
    /// Below `above_hz` there may be more than noise, but not less: those bands only bound it. A corner below `above_hz`
    /// is known as well as the shape of its tail (within a factor of two over a minute at half of it), and the power below
    /// with it. White noise where memory
    /// does not show, or there are fewer than three bands above; `None` without any.
    pub fn fit(
        bands: &[SpectrumBand],
        above_hz: f64,
        rate_hz: f64,
        gain: impl Fn(f64) -> f64,
        known: impl Fn(f64) -> f64,
    ) -> Option<Self> {
        let points: Vec<Point> = bands
            .iter()
            .filter(|b| b.psd > 0.0)
            .map(|b| Point {
                psd: b.psd,
                known: known(b.frequency_hz),
                gain: gain(b.frequency_hz),
                frequency_hz: b.frequency_hz,
                weight: (INDEPENDENT * b.values).max(1.0),
                bound_only: b.frequency_hz < above_hz,
            })
            .collect();
        let above = points.iter().filter(|p| !p.bound_only).count();
        if above == 0 {
            return None;
        }
        let fit = |corner: Option<f64>| {
            let shape = |p: &Point| corner.map_or(0.0, |c| p.gain * markov_shape(p.frequency_hz, c, rate_hz));
            let shapes: Vec<[f64; 2]> = points.iter().map(|p| [p.gain * 2.0 / rate_hz, shape(p)]).collect();
            let (powers, cost) = powers(&points, &shapes);
            (corner, powers, cost)
        };
        let white = fit(None);
        let mut chosen = white;
        if above >= 3 {
            let step = (HIGHEST_CORNER / LOWEST_CORNER).powf(1.0 / (CORNERS - 1) as f64);
            let fits: Vec<_> =
                (0..CORNERS).map(|k| fit(Some(rate_hz * LOWEST_CORNER * step.powi(k as i32)))).collect();
            let best = fits.iter().map(|f| f.2).fold(f64::INFINITY, f64::min);
            if white.2 - best > MEMORY_BRINGS {
                chosen = fits.into_iter().find(|f| f.2 <= best).unwrap_or(white);
            }
        }
        let (corner, [white, markov], _) = chosen;
        Some(Self {
            white_std: white.sqrt(),
            markov_std: markov.sqrt(),
            corner_hz: corner.unwrap_or(0.0),
            rate_hz,
        })
    }
}

/// Spectrum of a Gauss–Markov process of unit variance.
fn markov_shape(frequency_hz: f64, corner_hz: f64, rate_hz: f64) -> f64 {
    let turn = std::f64::consts::TAU / rate_hz;
    let a = libm::exp(-turn * corner_hz);
    2.0 / rate_hz * (1.0 - a * a) / (1.0 - 2.0 * a * libm::cos(turn * frequency_hz) + a * a)
}

struct Point {
    psd: f64,
    known: f64,
    gain: f64,
    frequency_hz: f64,
    weight: f64,
    bound_only: bool,
}

/// The two non-negative powers of least cost, and that cost.
fn powers(points: &[Point], shapes: &[[f64; 2]]) -> ([f64; 2], f64) {
    let sum = |p: &Point, shape: &[f64; 2], x: &[f64; 2]| p.known + x[0] * shape[0] + x[1] * shape[1];
    // Half of each part explains the upper end; the rounds do the rest.
    let last = points.iter().zip(shapes).next_back();
    let mut x = last.map_or([0.0; 2], |(p, s)| [p.psd / s[0].max(f64::MIN_POSITIVE), 0.0]);
    for round in 0..ROUNDS {
        let (mut a, mut b) = ([[0.0; 2]; 2], [0.0; 2]);
        for (p, shape) in points.iter().zip(shapes) {
            let model = sum(p, shape, &x);
            if p.bound_only && model <= p.psd || model <= 0.0 {
                continue;
            }
            // The first rounds take all bands as they are, in units of the spectrum itself.
            let unit = if round < 3 { p.psd } else { model };
            let excess = p.psd / (TOO_MUCH * model);
            let trust = if round < 3 || excess <= 1.0 { 1.0 } else { 1.0 / (excess * excess) };
            let weight = p.weight * trust / (unit * unit);
            for i in 0..2 {
                for j in 0..2 {
                    a[i][j] += weight * shape[i] * shape[j];
                }
                b[i] += weight * shape[i] * (p.psd - p.known);
            }
        }
        x = nonnegative(a, b);
    }
    let cost = points
        .iter()
        .zip(shapes)
        .map(|(p, shape)| {
            let model = sum(p, shape, &x).max(f64::MIN_POSITIVE);
            let ratio = p.psd / model;
            // ln S + Ŝ/S less its least value; what exceeds the fit by far counts like TOO_MUCH and half of its log.
            let beyond = (ratio / TOO_MUCH).max(1.0);
            let ratio = ratio.min(TOO_MUCH);
            let cost = ratio - 1.0 - ratio.ln() + 0.5 * beyond.ln();
            if p.bound_only && model <= p.psd { 0.0 } else { p.weight * cost }
        })
        .sum();
    (x, cost)
}

/// Minimises ½xᵀAx − bᵀx over x ≥ 0 for two unknowns.
fn nonnegative(a: [[f64; 2]; 2], b: [f64; 2]) -> [f64; 2] {
    let determinant = a[0][0] * a[1][1] - a[0][1] * a[1][0];
    if determinant > 1e-12 * a[0][0] * a[1][1] {
        let x = [
            (b[0] * a[1][1] - b[1] * a[0][1]) / determinant,
            (b[1] * a[0][0] - b[0] * a[1][0]) / determinant,
        ];
        if x[0] >= 0.0 && x[1] >= 0.0 {
            return x;
        }
    }
    let single = |i: usize| if a[i][i] > 0.0 { (b[i] / a[i][i]).max(0.0) } else { 0.0 };
    let gain = |i: usize| b[i] * single(i) - 0.5 * a[i][i] * single(i).powi(2);
    if gain(0) >= gain(1) { [single(0), 0.0] } else { [0.0, single(1)] }
}

#[cfg(test)]
mod tests {
    use super::super::spectrum::MedianSpectrum;
    use super::WhiteAndMarkov;
    use crate::noise::Normal;

    fn series(truth: &WhiteAndMarkov, seconds: f64, seed: u64) -> Vec<f64> {
        let mut normal = Normal::new(seed);
        let a = (-std::f64::consts::TAU * truth.corner_hz / truth.rate_hz).exp();
        let mut state = truth.markov_std * normal.next();
        (0..(seconds * truth.rate_hz) as usize)
            .map(|_| {
                state = a * state + truth.markov_std * (1.0 - a * a).sqrt() * normal.next();
                state + truth.white_std * normal.next()
            })
            .collect()
    }

    /// Root mean square up to a frequency.
    fn below(noise: &WhiteAndMarkov, frequency_hz: f64) -> f64 {
        let step = 0.05;
        let points = (frequency_hz / step) as usize;
        (0..points).map(|k| noise.psd((k as f64 + 0.5) * step) * step).sum::<f64>().sqrt()
    }

    fn fitted(truth: &WhiteAndMarkov, above_hz: f64, seed: u64) -> WhiteAndMarkov {
        let mut spectrum = MedianSpectrum::new(truth.rate_hz, 4.0 / above_hz);
        spectrum.push(&series(truth, 60.0, seed), |_| true);
        WhiteAndMarkov::fit(&spectrum.bands(1.25), above_hz, truth.rate_hz, |_| 1.0, |_| 0.0).unwrap()
    }

    #[test]
    fn memory_is_found_from_what_lies_above() {
        for (k, corner_hz) in [10.0, 10.0, 20.0, 20.0, 50.0, 50.0].into_iter().enumerate() {
            let truth = WhiteAndMarkov { white_std: 0.1, markov_std: 0.1, corner_hz, rate_hz: 500.0 };
            let found = fitted(&truth, 10.0, 100 + k as u64);
            let ratio = below(&found, 20.0) / below(&truth, 20.0);
            assert!((0.85..1.12).contains(&ratio), "{corner_hz} Hz: {ratio}, {found:?}");
        }
    }

    #[test]
    fn white_noise_has_no_memory() {
        for seed in 1..8 {
            let truth = WhiteAndMarkov::white(0.3, 500.0);
            let found = fitted(&truth, 10.0, seed);
            assert_eq!(found.markov_std, 0.0, "{found:?}");
            assert!((found.white_std / 0.3 - 1.0).abs() < 0.03, "{found:?}");
        }
    }

    #[test]
    fn what_is_known_to_be_there_is_not_noise() {
        let truth = WhiteAndMarkov::white(0.3, 500.0);
        let mut spectrum = MedianSpectrum::new(500.0, 0.4);
        spectrum.push(&series(&truth, 60.0, 4), |_| true);
        let half = truth.psd(1.0) / 2.0;
        let found = WhiteAndMarkov::fit(&spectrum.bands(1.25), 10.0, 500.0, |_| 1.0, |_| half).unwrap();
        assert!((found.white_std.powi(2) / 0.045 - 1.0).abs() < 0.05, "{found:?}");
    }
}
