//! The noise of measured positions: white noise, and the lattice of the encoder.

use super::lattice::lattice_step;
use super::white::level_and_order;
use crate::noise::median_step_s;

/// Bins of the lattice error's spectrum between 0 and half the sampling rate.
const BINS: usize = 512;
/// Harmonics of the saw-tooth that are followed; what is beyond them has 2 % of its power and is taken as white.
const HARMONICS: usize = 30;
/// A whole turn in fixed point, and a bin of the folded half of it.
const TURN: f64 = 4_294_967_296.0;
const FOLDED_BIN: u32 = (1 << 31) / BINS as u32;
/// Half of the time over which a joint's speed is taken, s: motion is far slower than this.
const HALF_SPEED_S: f64 = 0.04;
/// Fractional part of the golden ratio.
const GOLDEN: f64 = 0.618_033_988_749_895;
/// White noise is distinguished from the lattice's own error where the differences have this many times its power.
const BEYOND_LATTICE: f64 = 1.3;

/// Noise of a series of positions as recorded, before any interpolation and filter.
#[derive(Debug, Clone, PartialEq)]
pub struct PositionNoise {
    /// Standard deviation of the white noise beside the lattice's error, rad.
    pub white_rad: f64,
    /// Step of the encoder's lattice (or of the last decimal written), rad.
    pub step_rad: Option<f64>,
    /// Median rate of the samples, Hz.
    pub rate_hz: f64,
    /// One-sided spectrum of the lattice's error in equal bins up to half the rate, rad²/Hz.
    lattice: Vec<f64>,
}

impl PositionNoise {
    /// No noise at all, of samples at a rate.
    pub const fn none(rate_hz: f64) -> Self {
        Self { white_rad: 0.0, step_rad: None, rate_hz, lattice: Vec::new() }
    }

    /// The noise of positions in rad at stamps in s.
    ///
    /// On a lattice of step Δ the error of a joint that moves with the speed v is a saw-tooth of the frequency v/Δ and the
    /// power Δ²/12: harmonic k has Δ²/(2π²k²) at k v/Δ, folded into the band of the samples, and less by
    /// e^{−(2πkσ/Δ)²} under white noise σ, which turns the rest white (Bennett 1948; Widrow and Kollár 2008, ch. 5). A
    /// resting joint's error is constant.
    pub fn of(time_s: &[f64], position_rad: &[f64]) -> Self {
        let Some(step_s) = median_step_s(time_s) else { return Self::none(1.0) };
        let rate_hz = 1.0 / step_s;
        let Some((level, order)) = level_and_order(time_s, position_rad) else {
            return Self::none(rate_hz);
        };
        let step_rad = lattice_step(position_rad);
        let Some(step) = step_rad else {
            return Self { white_rad: level, step_rad, rate_hz, lattice: Vec::new() };
        };
        let saw_tooth = SawTooth::of(&speeds(time_s, position_rad, rate_hz, step), step, rate_hz);
        let mut noise = Self { white_rad: 0.0, step_rad, rate_hz, lattice: saw_tooth.spectrum(0.0) };
        // Two rounds: white noise spreads the lattice's error, and that is taken from what is white.
        for _ in 0..2 {
            let own = noise.in_differences(order);
            let beside = level * level - own;
            noise.white_rad = if level * level > BEYOND_LATTICE * own { beside.max(0.0).sqrt() } else { 0.0 };
            noise.lattice = saw_tooth.spectrum(noise.white_rad);
        }
        noise
    }

    /// One-sided power spectrum at a frequency up to half the rate, rad²/Hz; nothing above.
    pub fn psd(&self, frequency_hz: f64) -> f64 {
        let nyquist_hz = 0.5 * self.rate_hz;
        if frequency_hz > nyquist_hz {
            return 0.0;
        }
        let bin = ((frequency_hz / nyquist_hz * BINS as f64) as usize).min(BINS - 1);
        self.white_rad * self.white_rad / nyquist_hz + self.lattice.get(bin).copied().unwrap_or(0.0)
    }

    /// Mean square of the noise in accelerations below a frequency, (rad/s²)²: ∫ (2πf)⁴ S(f) df.
    pub fn acceleration_power(&self, below_hz: f64) -> f64 {
        let width_hz = below_hz / BINS as f64;
        let power = |bin: usize| {
            let frequency_hz = (bin as f64 + 0.5) * width_hz;
            self.psd(frequency_hz) * (std::f64::consts::TAU * frequency_hz).powi(4) * width_hz
        };
        (0..BINS).map(power).sum()
    }

    /// Power of the lattice's error in differences of an order, scaled to unit gain of white noise.
    fn in_differences(&self, order: usize) -> f64 {
        let width_hz = 0.5 * self.rate_hz / BINS as f64;
        let gain = |bin: usize| {
            let half = 0.5 * std::f64::consts::PI * (bin as f64 + 0.5) / BINS as f64;
            (2.0 * libm::sin(half)).powi(2 * order as i32)
        };
        let white: f64 = (0..BINS).map(gain).sum::<f64>() / BINS as f64;
        self.lattice.iter().enumerate().map(|(bin, psd)| psd * width_hz * gain(bin)).sum::<f64>() / white
    }
}

/// Speed at every sample that moves, rad/s; those that rest count as `None`.
fn speeds(time_s: &[f64], position_rad: &[f64], rate_hz: f64, step: f64) -> Vec<Option<f64>> {
    let half = ((HALF_SPEED_S * rate_hz).round() as usize).max(1);
    let last = position_rad.len().saturating_sub(1);
    (0..position_rad.len())
        .map(|k| {
            let (from, to) = (k.saturating_sub(half), (k + half).min(last));
            let (moved, took_s) = (position_rad[to] - position_rad[from], time_s[to] - time_s[from]);
            // The distance is a multiple of the step; the golden ratio's multiples fill the space between them evenly, else
            // all power would lie at a few frequencies.
            let between = (k as f64 * GOLDEN).fract() - 0.5;
            (moved.abs() > 0.5 * step && took_s > 0.0)
                .then(|| (moved.abs() + between * step).max(0.0) / took_s)
        })
        .collect()
}

/// The lattice's error of a joint that moves: how often each of its harmonics lies in each bin.
struct SawTooth {
    step: f64,
    rate_hz: f64,
    samples: usize,
    resting: usize,
    /// `[harmonic][bin]`.
    counts: Vec<[u32; BINS]>,
}

impl SawTooth {
    fn of(speeds: &[Option<f64>], step: f64, rate_hz: f64) -> Self {
        let mut counts = vec![[0; BINS]; HARMONICS];
        // Turns of the saw-tooth from sample to sample as a fraction of 2³²: multiples then fold by themselves.
        let per_speed = 1.0 / (step * rate_hz);
        for speed in speeds.iter().flatten() {
            let turns = speed * per_speed;
            let turn = ((turns - turns.floor()) * TURN) as u32;
            let mut phase = 0_u32;
            for counts in &mut counts {
                phase = phase.wrapping_add(turn);
                let bin = (phase.min(phase.wrapping_neg()) / FOLDED_BIN) as usize;
                counts[bin.min(BINS - 1)] += 1;
            }
        }
        let resting = speeds.iter().filter(|s| s.is_none()).count();
        Self { step, rate_hz, samples: speeds.len(), resting, counts }
    }

    /// The one-sided spectrum beside white noise, rad²/Hz.
    fn spectrum(&self, white_rad: f64) -> Vec<f64> {
        let strength = |k: usize| {
            let phase = std::f64::consts::TAU * k as f64 * white_rad / self.step;
            libm::exp(-phase * phase) * 6.0 / (std::f64::consts::PI * k as f64).powi(2)
        };
        let strengths: Vec<f64> = (1..=HARMONICS).map(strength).collect();
        let mut power = vec![0.0; BINS];
        for (share, counts) in strengths.iter().zip(&self.counts) {
            power.iter_mut().zip(counts).for_each(|(p, count)| *p += share * f64::from(*count));
        }
        // A resting joint shows its lattice only under noise that carries it over an edge.
        let at_rest = 1.0 - (strengths[0] / 0.607_927).clamp(0.0, 1.0);
        let moving = 1.0 - strengths.iter().sum::<f64>();
        let spread = self.resting as f64 * at_rest + (self.samples - self.resting) as f64 * moving;
        let width_hz = 0.5 * self.rate_hz / BINS as f64;
        let each = self.step * self.step / 12.0 / self.samples.max(1) as f64 / width_hz;
        power.iter().map(|p| each * (p + spread / BINS as f64)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::PositionNoise;
    use crate::noise::Normal;
    use crate::preprocess::ZeroPhase;
    use crate::preprocess::span::inner_acceleration;

    fn motion(seconds: f64, rate_hz: f64) -> (Vec<f64>, Vec<f64>) {
        let count = (seconds * rate_hz) as usize;
        let time: Vec<f64> = (0..count).map(|k| k as f64 / rate_hz).collect();
        let angle = time.iter().map(|t| 0.7 * (1.9 * t).sin() + 0.35 * (4.3 * t).cos()).collect();
        (time, angle)
    }

    /// Mean square of the accelerations' error behind a low-pass, true and as the spectrum says.
    fn acceleration_error(step: f64, noise: f64, rate_hz: f64, cutoff_hz: f64) -> (f64, f64) {
        let (time, angle) = motion(40.0, rate_hz);
        let mut normal = Normal::new(9);
        let shown: Vec<f64> = angle
            .iter()
            .map(|q| q + noise * normal.next())
            .map(|q| if step > 0.0 { (q / step).round() * step } else { q })
            .collect();
        let found = PositionNoise::of(&time, &shown);
        let filter = ZeroPhase::butterworth(4, cutoff_hz, rate_hz).unwrap();
        let error: Vec<f64> = shown.iter().zip(&angle).map(|(a, b)| a - b).collect();
        let error = inner_acceleration(&filter.filter(&error).unwrap(), 1.0 / rate_hz);
        let actual = error.iter().map(|e| e * e).sum::<f64>() / error.len() as f64;
        let points = 4000;
        let width_hz = 0.5 * rate_hz / f64::from(points);
        let said: f64 = (0..points)
            .map(|k| (f64::from(k) + 0.5) * width_hz)
            .map(|f| {
                let gain = filter.gain(f) * super::super::acceleration_gain(f, rate_hz);
                found.psd(f) * gain * gain * width_hz
            })
            .sum();
        (said, actual)
    }

    #[test]
    fn white_noise_of_encoders_is_found_in_accelerations() {
        for noise in [1e-6, 1e-5, 1e-4] {
            for rate_hz in [100.0, 250.0, 1000.0] {
                let (said, actual) = acceleration_error(0.0, noise, rate_hz, 0.1 * rate_hz);
                let ratio = (said / actual).sqrt();
                assert!((0.9..1.1).contains(&ratio), "{noise} rad, {rate_hz} Hz: {ratio}");
            }
        }
    }

    #[test]
    fn the_error_of_a_lattice_is_found_in_accelerations() {
        for bits in [12, 14, 16, 18, 20] {
            let step = std::f64::consts::TAU / f64::from(1 << bits);
            for rate_hz in [100.0, 500.0] {
                let (said, actual) = acceleration_error(step, 0.0, rate_hz, 0.08 * rate_hz);
                let ratio = (said / actual).sqrt();
                assert!((0.85..1.18).contains(&ratio), "{bits} bits, {rate_hz} Hz: {ratio}");
            }
        }
    }

    #[test]
    fn noise_on_a_lattice_is_both() {
        for share in [0.2, 0.5, 2.0] {
            let (said, actual) = acceleration_error(1e-4, 1e-4 * share, 500.0, 50.0);
            let ratio = (said / actual).sqrt();
            assert!((0.85..1.18).contains(&ratio), "{share} of a step: {ratio}");
        }
    }
}
