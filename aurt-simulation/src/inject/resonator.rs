//! The answer of a resonator, ω²/(s² + 2ζωs + ω²), to a series at uneven stamps.

const STEPS_PER_RADIAN: f64 = 8.0;
/// Faster resonators are not followed, rad/s: they answer like rigid joints up to every cut-off in use (500 Hz).
const FASTEST_RAD_S: f64 = 3000.0;

/// The answer to `input`, which is joined linearly; at rest at the first sample's value.
pub(super) fn answer(time_s: &[f64], input: &[f64], rate_rad_s: f64, damping_ratio: f64) -> Vec<f64> {
    let rate = rate_rad_s.min(FASTEST_RAD_S);
    let mut x = input.first().copied().unwrap_or(0.0);
    let mut v = 0.0;
    let mut answers = Vec::with_capacity(input.len());
    answers.extend(input.first().copied());
    for (times, inputs) in time_s.windows(2).zip(input.windows(2)) {
        let duration = times[1] - times[0];
        let steps = (duration * rate * STEPS_PER_RADIAN).ceil().max(1.0);
        let h = duration / steps;
        for step in 0..steps as usize {
            let share = (step as f64 + 0.5) / steps;
            let u = inputs[0] + share * (inputs[1] - inputs[0]);
            // Velocity by the implicit midpoint rule, which keeps an undamped resonator's amplitude.
            let (a, b) = (0.25 * h * h * rate * rate, h * damping_ratio * rate);
            let next = (v * (1.0 - a - b) + h * rate * rate * (u - x)) / (1.0 + a + b);
            x += 0.5 * h * (v + next);
            v = next;
        }
        answers.push(x);
    }
    answers
}

#[cfg(test)]
mod tests {
    use super::answer;

    /// Gain and phase against 1/(1 − r² + 2ζr i) at r = ½.
    #[test]
    fn a_sine_passes_as_the_transfer_function_says() {
        let (rate, zeta, omega) = (20.0, 0.3, 10.0);
        let time: Vec<f64> = (0..4000).map(|k| 0.005 * f64::from(k)).collect();
        let input: Vec<f64> = time.iter().map(|t| libm::sin(omega * t)).collect();
        let output = answer(&time, &input, rate, zeta);
        let (re, im) = (1.0 - 0.25, 2.0 * zeta * 0.5);
        let (gain, phase) = (1.0 / (re * re + im * im).sqrt(), -libm::atan2(im, re));
        for k in 2000..4000 {
            let wanted = gain * libm::sin(omega * time[k] + phase);
            assert!((output[k] - wanted).abs() < 0.01, "{} {wanted}", output[k]);
        }
    }
}
