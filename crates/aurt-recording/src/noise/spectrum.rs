//! The power spectrum of a series in pieces, robust against bursts and lines.

use std::ops::Range;

use super::fourier;
use crate::preprocess::clock::median;

/// Lowest bin that counts: the trend that is taken off each piece, and the window, belong to those below.
const LOWEST_BIN: usize = 2;

/// Fewer pieces than this have no medians of their own.
const FEW_PIECES: usize = 10;

/// Periodograms of pieces of one length, of which medians are taken: a burst spoils few pieces, a line few bins.
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
    #[must_use]
    pub fn new(rate_hz: f64, piece_s: f64) -> Self {
        let length = ((piece_s * rate_hz).max(1.0) as usize).clamp(16, 1 << 14).next_power_of_two();
        let window = (0..length)
            .map(|k| 0.5 - 0.5 * libm::cos(std::f64::consts::TAU * (k as f64 + 0.5) / length as f64))
            .collect();
        Self { rate_hz, window, pieces: Vec::new() }
    }

    /// Samples of a piece.
    #[must_use]
    pub const fn length(&self) -> usize {
        self.window.len()
    }

    /// Number of pieces taken in.
    #[must_use]
    pub const fn pieces(&self) -> usize {
        self.pieces.len()
    }

    /// Takes in the pieces of a series in which all samples are usable, half a piece apart.
    pub fn push(&mut self, series: &[f64], usable: impl Fn(usize) -> bool) {
        let length = self.length();
        let mut start = 0;
        while start + length <= series.len() {
            if let Some(spoilt) = (start..start + length).rev().find(|k| !usable(*k)) {
                start = spoilt + 1;
                continue;
            }
            self.pieces.push(self.periodogram(&series[start..start + length]));
            start += length / 2;
        }
    }

    /// 2 |X_m|² / (rate Σ w²) of a piece less its straight line.
    fn periodogram(&self, piece: &[f64]) -> Vec<f64> {
        let n = piece.len() as f64;
        let mean = piece.iter().sum::<f64>() / n;
        let (mut cross, mut power) = (0.0, 0.0);
        for (k, value) in piece.iter().enumerate() {
            let x = k as f64 - 0.5 * (n - 1.0);
            cross += x * (value - mean);
            power += x * x;
        }
        let slope = cross / power;
        let windowed: Vec<f64> = piece
            .iter()
            .zip(&self.window)
            .enumerate()
            .map(|(k, (value, w))| w * (value - mean - slope * (k as f64 - 0.5 * (n - 1.0))))
            .collect();
        let scale = 2.0 / (self.rate_hz * self.window.iter().map(|w| w * w).sum::<f64>());
        fourier::power(&windowed).iter().map(|p| scale * p).collect()
    }

    /// Medians over pieces and neighbouring bins, in bands whose edges grow by `ratio`.
    #[must_use]
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
}

impl MedianSpectrum {
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

/// Mean of the upper median of `count` values that are exponentially distributed with mean one: ln 2 for many, and
/// Σ_{i=⌊n/2⌋…} 1/i in general (order statistics of the exponential distribution).
fn median_share(count: usize) -> f64 {
    // The (m+1)-th smallest of n has the mean Σ_{i=n−m}^{n} 1/i, m = ⌊n/2⌋.
    ((count - count / 2).max(1)..=count).map(|i| 1.0 / i as f64).sum()
}

#[cfg(test)]
mod tests {
    use super::super::fourier::tests::Normal;
    use super::MedianSpectrum;

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
    fn unusable_samples_take_no_part() {
        let mut spectrum = MedianSpectrum::new(100.0, 0.3);
        let length = spectrum.length();
        let series = vec![1.0; 5 * length];
        spectrum.push(&series, |k| k != 2 * length);
        assert_eq!(spectrum.pieces(), 3 + 4, "before 2 and after 2 lengths, half a length apart");
    }
}
