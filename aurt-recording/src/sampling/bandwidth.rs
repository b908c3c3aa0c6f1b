//! The frequencies of a motion, and the f_dyn that suits it.

use crate::noise::{PositionNoise, power, velocity_gain};
use crate::preprocess::Preprocessed;

const F_DYN_HZ: [f64; 10] = [1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, RIGID_HZ];
/// f_dyn over the frequency below which the motion lies: friction turns smooth motion into odd harmonics of it.
const ROOM: f64 = 5.0;
/// Share of the power of a motion that lies below that frequency.
const SHARE: f64 = 0.999;
/// Arms are rigid below this frequency, Hz: the lowest resonances of their gears lie at 10 Hz and above, and no model of rigid
/// links follows them.
const RIGID_HZ: f64 = 10.0;
/// Largest share of the shortest recording that the filters' memory, 1.7 / f_dyn, may have: rows so near to its ends, to gaps and to
/// reversals that are left out do not count.
const MEMORY_SHARE: f64 = 1.0 / 50.0;
/// That memory in periods of f_dyn (docs/mathematics.md, ends and gaps).
const MEMORY_PERIODS: f64 = 1.7;
/// Largest share of noise in the power of the accelerations. Its torque is then 1 % of that which moves the links, as much as what a good
/// model lacks; inertias become smaller by the share itself.
const NOISE_SHARE: f64 = 1e-4;

/// The f_dyn that suits recordings whose `position_noise` was estimated. `None` if nothing moves.
///
/// Let f be the frequency below which 99.9 % of the power of the velocities of all joints and recordings lies. It is the lowest round
/// one of at least 5 f and 85 / T, with T the length of the shortest recording, at most 10 Hz; lower where noise of the positions
/// below it has more than 0.01 % of the power of the accelerations, but not below f. The position filter, at 5 f_dyn, lies below half
/// of each sampling rate.
///
/// Power is summed over the joints, so that a joint that hardly moves, and trembles instead, does not decide; a recording has the
/// weight of its mean power, whatever its length and rate.
pub fn suitable_f_dyn_hz<'a>(recordings: impl IntoIterator<Item = &'a Preprocessed>) -> Option<f64> {
    Band::of(recordings).suitable_hz()
}

/// `asked_hz`, or the highest usual f_dyn below it, at which noise of the positions has at most 0.01 % of the power of the
/// accelerations: beyond, what is missing drowns in it. Never less than what suits ([`suitable_f_dyn_hz`]).
pub fn quiet_f_dyn_hz<'a>(recordings: impl IntoIterator<Item = &'a Preprocessed>, asked_hz: f64) -> f64 {
    Band::of(recordings).quiet_hz(asked_hz)
}

/// Motions and noise of recordings.
struct Band<'a> {
    /// Frequencies, Hz, and mean power of the joints' velocities at each.
    velocities: Vec<(f64, f64)>,
    noises: Vec<&'a PositionNoise>,
    slowest_hz: f64,
    shortest_s: f64,
}

impl<'a> Band<'a> {
    fn of(recordings: impl IntoIterator<Item = &'a Preprocessed>) -> Self {
        let none = f64::INFINITY;
        let mut band =
            Self { velocities: Vec::new(), noises: Vec::new(), slowest_hz: none, shortest_s: none };
        for recording in recordings {
            let samples: usize = recording.segments.iter().map(|s| s.motion.samples()).sum();
            band.shortest_s = band.shortest_s.min(samples as f64 / recording.report.rate_hz);
            band.slowest_hz = band.slowest_hz.min(recording.report.rate_hz);
            let joints = 0..recording.position_noise.len();
            band.velocities.extend(joints.flat_map(|joint| recording.velocity_spectrum(joint)));
            band.noises.extend(&recording.position_noise);
        }
        band
    }

    /// True where noise of the positions below a frequency has little of the accelerations' power.
    fn is_quiet(&self, f_dyn_hz: f64) -> bool {
        let accelerations: f64 =
            self.velocities.iter().map(|(f, power)| power * (std::f64::consts::TAU * f).powi(2)).sum();
        self.noises.iter().map(|noise| noise.acceleration_power(f_dyn_hz)).sum::<f64>()
            <= NOISE_SHARE * accelerations
    }

    fn quiet_hz(&self, asked_hz: f64) -> f64 {
        let Some(suitable_hz) = self.suitable_hz().filter(|suitable_hz| *suitable_hz < asked_hz) else {
            return asked_hz;
        };
        let lower = F_DYN_HZ.into_iter().rev().filter(|hz| *hz < asked_hz && *hz > suitable_hz);
        [asked_hz].into_iter().chain(lower).find(|hz| self.is_quiet(*hz)).unwrap_or(suitable_hz)
    }

    fn suitable_hz(&self) -> Option<f64> {
        let top_hz = reach_hz(self.velocities.clone())?;
        chosen_hz(top_hz, self.shortest_s, self.slowest_hz, |hz| self.is_quiet(hz))
    }
}

/// f_dyn for motion below `top_hz`, for a length and a sampling rate, where noise allows it only if it is `quiet`.
fn chosen_hz(top_hz: f64, shortest_s: f64, rate_hz: f64, quiet: impl Fn(f64) -> bool) -> Option<f64> {
    let possible: Vec<f64> = F_DYN_HZ.into_iter().filter(|f| 10.0 * f < rate_hz).collect();
    let least = |wanted_hz: f64| {
        possible.iter().position(|f| *f >= wanted_hz).unwrap_or(possible.len().saturating_sub(1))
    };
    let wanted_hz = (ROOM * top_hz).max(MEMORY_PERIODS / (MEMORY_SHARE * shortest_s));
    let [lowest, wanted] = [top_hz, wanted_hz].map(|hz| least(hz.min(RIGID_HZ)));
    let chosen = (lowest..=wanted).rev().find(|k| possible.get(*k).is_some_and(|f| quiet(*f)));
    possible.get(chosen.unwrap_or(lowest)).copied()
}

/// The frequency below which 99.9 % of the power of a spectrum lies; `None` without power.
fn reach_hz(mut spectrum: Vec<(f64, f64)>) -> Option<f64> {
    spectrum.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = spectrum.iter().map(|(_, power)| power).sum();
    let mut sum = 0.0;
    let reached = spectrum.into_iter().find(|(_, power)| {
        sum += power;
        sum >= SHARE * total
    });
    reached.map(|(frequency_hz, _)| frequency_hz).filter(|_| total > 0.0)
}

impl Preprocessed {
    /// The frequency below which 99.9 % of the power of a joint's velocity lies, in Hz, in the longest stretch without gaps; `None`
    /// if nothing exceeds the noise of its positions, or that was not estimated.
    pub fn bandwidth_hz(&self, joint: usize) -> Option<f64> {
        reach_hz(self.velocity_spectrum(joint))
    }

    /// The power of a joint's velocity above the noise of its positions in the longest stretch without gaps, frequency by frequency.
    fn velocity_spectrum(&self, joint: usize) -> Vec<(f64, f64)> {
        let longest = self.segments.iter().max_by_key(|s| s.motion.samples());
        let (Some(longest), Some(noise)) = (longest, self.position_noise.get(joint)) else {
            return Vec::new();
        };
        let filter = self.report.position_filter().ok();
        let velocity_noise_psd = |f: f64| {
            let filtered = filter.as_ref().map_or(1.0, |filter| filter.gain(f));
            noise.psd(f) * (filtered * velocity_gain(f, self.report.rate_hz)).powi(2)
        };
        spectrum(longest.motion.view().velocity_rad_s(joint), longest.rate_hz, velocity_noise_psd)
    }
}

/// Frequencies, Hz, and mean power of a uniformly sampled series at each, where it exceeds noise whose one-sided spectrum is
/// `noise_psd`; nothing of a series that is too short.
///
/// Hann's window keeps a series that does not end as it began from having power at all frequencies. A bin of noise of mean N
/// has more than x N with the probability e^−x: none of n bins has more than 2 N ln n but with the probability 1/n, and those
/// that have are motion.
fn spectrum(values: &[f64], rate_hz: f64, noise_psd: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
    const MOST_SAMPLES: usize = 4096;
    // Means of neighbours: what lies above the lower rate is not motion of an arm.
    let block = values.len().div_ceil(MOST_SAMPLES).max(1);
    let series: Vec<f64> =
        values.chunks_exact(block).map(|c| c.iter().sum::<f64>() / c.len() as f64).collect();
    let n = series.len();
    if n < 16 {
        return Vec::new();
    }
    let mean = series.iter().sum::<f64>() / n as f64;
    let turn = |k: usize| std::f64::consts::TAU * k as f64 / n as f64;
    let mut windowed: Vec<f64> =
        series.iter().enumerate().map(|(k, v)| (v - mean) * (0.5 - 0.5 * turn(k).cos())).collect();
    let block_rate_hz = rate_hz / block as f64;
    // Σ w² of Hann's window is 3n/8.
    let per_psd = 0.5 * block_rate_hz * 0.375 * n as f64;
    let noise = |frequency_hz: f64| -> f64 {
        // Means of neighbours fold what lies above half their rate.
        let aliases = (0..=block / 2).flat_map(|m| {
            let whole_hz = m as f64 * block_rate_hz;
            [whole_hz + frequency_hz, whole_hz - frequency_hz]
        });
        let passed = |f: f64| {
            let half = std::f64::consts::PI * f / rate_hz;
            noise_psd(f) * ((block as f64 * half).sin() / (block as f64 * half.sin())).powi(2)
        };
        per_psd * aliases.filter(|f| *f > 0.0 && *f <= 0.5 * rate_hz).map(passed).sum::<f64>()
    };
    let reach = 2.0 * (n as f64).ln();
    let length = n.next_power_of_two();
    windowed.resize(length, 0.0);
    let bin = |(k, power): (usize, f64)| {
        let frequency_hz = k as f64 * block_rate_hz / length as f64;
        let above = if power > reach * noise(frequency_hz) { power } else { 0.0 };
        // Half of Parseval's sum, and Hann's window again: the mean square.
        (frequency_hz, above / (0.1875 * (n * length) as f64))
    };
    power(&windowed).into_iter().enumerate().take(length / 2).skip(1).map(bin).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::Normal;

    #[test]
    fn the_band_has_room_where_arms_are_rigid_and_noise_allows_it() {
        let chosen = |top_hz, rate_hz, quiet_hz: f64| chosen_hz(top_hz, 100.0, rate_hz, |f| f <= quiet_hz);
        let quiet = f64::INFINITY;
        assert_eq!(chosen(0.6, 500.0, quiet), Some(3.0));
        assert_eq!(chosen(0.1, 500.0, quiet), Some(1.0));
        // Beyond rigid arms lie five times the motion's frequency, and what lost samples make of a motion.
        assert_eq!([4.0, 40.0].map(|top_hz| chosen(top_hz, 500.0, quiet)), [Some(10.0); 2]);
        // Noise, and the rate.
        assert_eq!(chosen(0.6, 500.0, 2.0), Some(2.0));
        assert_eq!(chosen(0.6, 500.0, 0.0), Some(1.0));
        assert_eq!(chosen(0.6, 25.0, quiet), Some(2.0));
        assert_eq!(chosen(0.6, 9.0, quiet), None);
        // Short recordings.
        let long = |shortest_s| chosen_hz(0.6, shortest_s, 500.0, |_| true);
        assert_eq!([60.0, 20.0, 10.0, 5.0].map(long), [3.0, 5.0, 10.0, 10.0].map(Some));
    }

    #[test]
    fn a_band_that_is_asked_for_is_as_wide_as_noise_allows() {
        let mut noise = PositionNoise::none(500.0);
        let mut quiet_hz = |white_rad, asked_hz| {
            noise.white_rad = white_rad;
            let (velocities, noises) = (vec![(1.0, 1.0)], vec![&noise]);
            Band { velocities, noises, slowest_hz: 500.0, shortest_s: 100.0 }.quiet_hz(asked_hz)
        };
        assert_eq!(quiet_hz(0.0, 30.0), 30.0);
        // σ²/250 (2π)⁴ f⁵/5 is a ten-thousandth of (2π)² at 8.1 Hz, and of a σ of a third at 12.6 Hz.
        assert_eq!([30.0, 8.1].map(|asked_hz| quiet_hz(3e-4, asked_hz)), [8.0, 8.1]);
        assert_eq!([30.0, 12.0].map(|asked_hz| quiet_hz(1e-4, asked_hz)), [10.0, 12.0]);
        // What suits the motion is the least, whatever the noise.
        assert_eq!([quiet_hz(1.0, 30.0), quiet_hz(1.0, 0.5)], [1.0, 0.5]);
    }

    #[test]
    fn the_highest_of_several_tones_is_found() {
        let tone = |f: f64, t: f64| (std::f64::consts::TAU * f * t).sin();
        let series: Vec<f64> = (0..20_000)
            .map(|k| f64::from(k) / 500.0)
            .map(|t| tone(0.4, t) + 0.5 * tone(1.5, t) + 0.002 * tone(40.0, t))
            .collect();
        let found = reach_hz(spectrum(&series, 500.0, |_| 0.0)).unwrap();
        assert!((found - 1.5).abs() < 0.05, "{found}");
        assert_eq!(reach_hz(spectrum(&[1.0; 400], 100.0, |_| 0.0)), None);
        // A joint that hardly moves and trembles does not decide beside it.
        let trembling: Vec<f64> = (0..20_000).map(|k| 1e-3 * tone(30.0, f64::from(k) / 500.0)).collect();
        let both = [&series, &trembling].map(|series| spectrum(series, 500.0, |_| 0.0)).concat();
        assert_eq!(reach_hz(both), Some(found));
    }

    /// A motion of 0.6 Hz that does not end as it began, with white noise of its positions as differentiation makes it.
    #[test]
    fn neither_noise_nor_the_ends_of_a_recording_are_motion() {
        let rate_hz = 500.0;
        let tau = std::f64::consts::TAU;
        for (samples, sigma) in [(6_150, 0.0), (6_150, 1e-5), (6_150, 1e-3), (70_000, 1e-4)] {
            let mut normal = Normal::new(1);
            let noise: Vec<f64> = (0..samples + 2).map(|_| sigma * normal.next()).collect();
            let velocity: Vec<f64> = (0..samples)
                .map(|k| {
                    let own = 0.5 * tau * 0.6 * (tau * 0.6 * k as f64 / rate_hz).cos();
                    own + 0.5 * rate_hz * (noise[k + 2] - noise[k])
                })
                .collect();
            let psd = |f: f64| sigma * sigma / (0.5 * rate_hz) * velocity_gain(f, rate_hz).powi(2);
            let found = reach_hz(spectrum(&velocity, rate_hz, psd)).unwrap();
            assert!((0.55..0.9).contains(&found), "{samples} {sigma}: {found}");
        }
    }
}
