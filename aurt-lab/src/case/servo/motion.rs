//! What the host tells the servos.

use aurt_simulation::Random;

/// The host sends a command, and logs it, this often, in s; a servo holds it until the next.
pub(super) const STREAM_S: f64 = 0.02;

/// Commands of some seconds, one every [`STREAM_S`]: slow and fast sines, then steps and ramps between poses with rests.
pub(super) fn commands(duration_s: f64, random: &mut Random) -> Vec<f64> {
    let all = (duration_s / STREAM_S) as usize;
    let waves = [0.5, 1.5, 4.5].map(|w| {
        let amplitude = random.between(0.2, 0.4) / f64::sqrt(w);
        [amplitude, w * random.between(0.8, 1.2), random.between(0.0, std::f64::consts::TAU)]
    });
    let sines = (random.between(0.35, 0.55) * all as f64) as usize;
    let at = |k: usize| -> f64 {
        let t = k as f64 * STREAM_S;
        waves.iter().map(|[a, w, p]| a * libm::sin(w * t + p)).sum()
    };
    let mut stream: Vec<f64> = (0..sines).map(at).collect();
    while stream.len() < all {
        let (from, to) = (stream[stream.len() - 1], random.between(-0.7, 0.7));
        let ramp_s = if random.chance(0.5) { random.between(0.06, 0.2) } else { random.between(0.5, 2.4) };
        let ramp = (ramp_s / STREAM_S) as usize;
        stream.extend((1..=ramp).map(|k| from + (to - from) * k as f64 / ramp as f64));
        let rest = (random.between(0.4, 1.2) / STREAM_S) as usize;
        stream.extend(std::iter::repeat_n(to, rest));
    }
    stream.truncate(all);
    stream
}
