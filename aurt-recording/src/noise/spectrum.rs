//! The power spectrum of a series in pieces, robust against bursts and lines.

use std::ops::Range;

use super::fourier;
use crate::noise::median;

/// Lowest bin that counts: the trend that is taken off each piece, and the window, belong to those below.
const LOWEST_BIN: usize = 2;

const FEW_PIECES: usize = 10;

/// A piece with more jolts than this has too little left of itself: a straight line and two shapes a jolt take up the
/// lowest five bins, which is what lies below f_dyn in pieces of four of its periods.
const MOST_JOLTS: usize = 4;

/// Share of a bin's power that shapes leave of it, at least; less says nothing of the rest.
const LEAST_LEFT: f64 = 0.1;

/// Periodograms of pieces of one length, of which medians are taken: a burst affects few pieces, a line few bins.
#[derive(Debug, Clone)]
pub struct MedianSpectrum {
    rate_hz: f64,
    window: Vec<f64>,
    /// `[piece][bin]`.
    pieces: Vec<Vec<f64>>,
}

/// The spectrum in a band of frequencies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpectrumBand {
    /// Geometric centre, Hz.
    pub frequency_hz: f64,
    /// One-sided power spectrum, unit²/Hz.
    pub psd: f64,
    /// Number of periodogram values whose median it is.
    pub values: f64,
}

impl MedianSpectrum {
    /// For pieces of about `piece_s`, in samples a power of two between 16 and 16 384.
    pub fn new(rate_hz: f64, piece_s: f64) -> Self {
        let length = ((piece_s * rate_hz).max(1.0) as usize).clamp(16, 1 << 14).next_power_of_two();
        let window = (0..length)
            .map(|k| 0.5 - 0.5 * libm::cos(std::f64::consts::TAU * (k as f64 + 0.5) / length as f64))
            .collect();
        Self { rate_hz, window, pieces: Vec::new() }
    }

    /// Samples of a piece.
    pub const fn length(&self) -> usize {
        self.window.len()
    }

    /// Number of pieces taken in.
    pub const fn pieces(&self) -> usize {
        self.pieces.len()
    }

    /// Takes in the pieces of a series in which all samples are usable, half a piece apart.
    pub fn push(&mut self, series: &[f64], usable: impl Fn(usize) -> bool) {
        let length = self.length();
        let mut start = 0;
        while start + length <= series.len() {
            if let Some(corrupt) = (start..start + length).rev().find(|k| !usable(*k)) {
                start = corrupt + 1;
                continue;
            }
            self.pieces.push(self.periodogram(&series[start..start + length], &[]));
            start += length / 2;
        }
    }

    /// Takes in all pieces of a series, half a piece apart, that jolts touch in no more than a few places: spans of samples
    /// within which the series steps. Of each piece a step and a hat at each of its jolts are taken off by least squares,
    /// so that dry friction of unknown size leaves no tail that looks like memory.
    pub fn push_between(&mut self, series: &[f64], jolts: &[Range<usize>]) {
        let length = self.length();
        for start in (0..).map(|k| k * (length / 2)).take_while(|start| start + length <= series.len()) {
            let end = start + length;
            let within: Vec<Range<f64>> = jolts
                .iter()
                .filter(|j| j.end > start && j.start < end)
                .map(|j| j.start as f64 - start as f64..j.end as f64 - start as f64)
                .collect();
            if within.len() <= MOST_JOLTS {
                self.pieces.push(self.periodogram(&series[start..end], &within));
            }
        }
    }

    /// 2 |X_m|² / (rate Σ w²) of a piece less its straight line, and less a step and a hat at each jolt.
    fn periodogram(&self, piece: &[f64], jolts: &[Range<f64>]) -> Vec<f64> {
        let mut shapes = vec![vec![1.0; piece.len()], (0..piece.len()).map(|k| k as f64).collect()];
        for jolt in jolts {
            let (middle, half) = (0.5 * (jolt.start + jolt.end), 0.5 * (jolt.end - jolt.start));
            let of =
                |shape: &dyn Fn(f64) -> f64| (0..piece.len()).map(|k| shape(k as f64 - middle)).collect();
            shapes.push(of(&|x| f64::from(x >= 0.0)));
            shapes.push(of(&|x| (1.0 - x.abs() / half.max(1.0)).max(0.0)));
        }
        let mut left = piece.to_vec();
        let described = take_off(&mut left, shapes);
        let windowed = |series: &[f64]| -> Vec<f64> {
            fourier::power(&series.iter().zip(&self.window).map(|(value, w)| w * value).collect::<Vec<_>>())
        };
        let all: f64 = self.window.iter().map(|w| w * w).sum();
        let mut power = windowed(&left);
        if !jolts.is_empty() {
            // Of white noise the shapes take Σ |W b|² of the window's power off a bin, which the rest stands for.
            let mut taken = vec![0.0; power.len()];
            for shape in &described {
                taken.iter_mut().zip(windowed(shape)).for_each(|(taken, of_it)| *taken += of_it / all);
            }
            power.iter_mut().zip(&taken).for_each(|(power, taken)| *power /= (1.0 - taken).max(LEAST_LEFT));
        }
        power.iter().map(|p| 2.0 / (self.rate_hz * all) * p).collect()
    }

    /// Medians over pieces and neighbouring bins, in bands whose edges grow by `ratio`.
    pub fn bands(&self, ratio: f64) -> Vec<SpectrumBand> {
        let bins = self.length() / 2;
        let bin_hz = self.rate_hz / self.length() as f64;
        let mut bands = Vec::new();
        let mut from = LOWEST_BIN;
        while from < bins && !self.pieces.is_empty() {
            let to = ((from as f64 * ratio).floor() as usize).max(from + 1).min(bins);
            let psd = self.level(from..to);
            let count = self.pieces.len() * (to - from);
            let frequency_hz = bin_hz * (from as f64 * (to - 1) as f64).sqrt();
            bands.push(SpectrumBand { frequency_hz, psd, values: count as f64 });
            from = to;
        }
        bands
    }

    /// The median over bins of the medians over pieces; over all values at once where there are few pieces, whose own
    /// medians scatter too unevenly.
    fn level(&self, bins: Range<usize>) -> f64 {
        let level_of = |mut values: Vec<f64>| {
            let count = values.len();
            median(&mut values) / median_share(count)
        };
        if self.pieces.len() < FEW_PIECES {
            return level_of(
                self.pieces.iter().flat_map(|piece| piece[bins.clone()].iter().copied()).collect(),
            );
        }
        let mut levels: Vec<f64> =
            bins.map(|bin| level_of(self.pieces.iter().map(|piece| piece[bin]).collect())).collect();
        levels.sort_unstable_by(f64::total_cmp);
        let middle = levels.len() / 2;
        if levels.len() % 2 == 1 { levels[middle] } else { 0.5 * (levels[middle - 1] + levels[middle]) }
    }
}

/// Takes the part of a series that shapes describe off it, and gives the shapes made orthonormal (Gram–Schmidt).
fn take_off(series: &mut [f64], shapes: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let less = |from: &mut [f64], times: f64, shape: &[f64]| {
        from.iter_mut().zip(shape).for_each(|(value, s)| *value -= times * s);
    };
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for mut shape in shapes {
        let before = dot(&shape, &shape);
        for known in &basis {
            let share = dot(&shape, known);
            less(&mut shape, share, known);
        }
        let power = dot(&shape, &shape);
        // What others describe already is nothing new.
        if power <= 1e-9 * before {
            continue;
        }
        shape.iter_mut().for_each(|s| *s /= power.sqrt());
        less(series, dot(series, &shape), &shape);
        basis.push(shape);
    }
    basis
}

/// Mean of the upper median of `count` values that are exponentially distributed with mean one: ln 2 for many, and
/// Σ_{i=⌊n/2⌋…} 1/i in general (order statistics of the exponential distribution).
fn median_share(count: usize) -> f64 {
    // The (m+1)-th smallest of n has the mean Σ_{i=n−m}^{n} 1/i, m = ⌊n/2⌋.
    ((count - count / 2).max(1)..=count).map(|i| 1.0 / i as f64).sum()
}

#[cfg(test)]
mod tests {
    use super::MedianSpectrum;
    use crate::noise::Normal;

    #[test]
    fn the_level_of_white_noise_is_seen_beneath_a_line_and_bursts() {
        let mut normal = Normal::new(21);
        let rate_hz = 500.0;
        let series: Vec<f64> = (0..20_000)
            .map(|k| {
                let line = 0.5 * (std::f64::consts::TAU * 100.0 * f64::from(k) / rate_hz).sin();
                let burst = if k % 4000 < 60 { 3.0 } else { 1.0 };
                0.2 * normal.next() * burst + line
            })
            .collect();
        let mut spectrum = MedianSpectrum::new(rate_hz, 0.5);
        spectrum.push(&series, |_| true);
        let white = 2.0 * 0.04 / rate_hz;
        for band in spectrum.bands(1.3).iter().filter(|b| b.frequency_hz > 30.0) {
            assert!((band.psd / white - 1.0).abs() < 0.2, "{band:?} of {white}");
        }
    }

    #[test]
    fn steps_of_friction_leave_the_level_of_the_noise() {
        let mut normal = Normal::new(22);
        let (rate_hz, length) = (125.0, 5_000);
        // A joint that turns every 60 samples, at the sample at which it is expected to, against 3 Nm of friction.
        let turns: Vec<usize> = (1..length / 60).map(|k| 60 * k).collect();
        let series: Vec<f64> = (0..length)
            .map(|k| {
                let sign = if k / 60 % 2 == 0 { 3.0 } else { -3.0 };
                sign + 0.2 * normal.next()
            })
            .collect();
        let jolts: Vec<_> = turns.iter().map(|turn| turn - 12..turn + 12).collect();
        let white = 2.0 * 0.04 / rate_hz;
        let mut plain = MedianSpectrum::new(rate_hz, 0.8);
        plain.push(&series, |_| true);
        let mut between = MedianSpectrum::new(rate_hz, 0.8);
        between.push_between(&series, &jolts);
        let at = |spectrum: &MedianSpectrum| {
            spectrum.bands(1.3).iter().find(|b| b.frequency_hz > 6.0).map_or(0.0, |b| b.psd / white)
        };
        assert!(at(&plain) > 10.0, "{}", at(&plain));
        assert!((0.5..2.5).contains(&at(&between)), "{}", at(&between));
    }

    #[test]
    fn unusable_samples_take_no_part() {
        let mut spectrum = MedianSpectrum::new(100.0, 0.3);
        let length = spectrum.length();
        let series = vec![1.0; 5 * length];
        spectrum.push(&series, |k| k != 2 * length);
        assert_eq!(spectrum.pieces(), 3 + 4, "before 2 and after 2 lengths, half a length apart");
    }
}
