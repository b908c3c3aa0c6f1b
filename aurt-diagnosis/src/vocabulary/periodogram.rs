//! Orders of the joint angle at which a residual repeats.

use crate::vocabulary::proposal::Context;

/// Highest order that is looked for: a harmonic drive of ratio 100 has 200 teeth on its flexspline.
const HIGHEST_ORDER: f64 = 240.0;

/// Peaks proposed per joint.
const PEAKS: usize = 3;

/// For each joint the orders N at which its residual follows sin(N q) and cos(N q) best: maxima of the
/// periodogram over q of all recordings, in steps that resolve the travelled range.
pub(crate) fn orders(context: &Context<'_>) -> Vec<(usize, f64)> {
    let mut found = Vec::new();
    for joint in 0..context.joints {
        let mut angles = Vec::new();
        let mut residual = Vec::new();
        for (recording, residuals) in context.recordings.iter().zip(context.residual) {
            angles.extend_from_slice(&recording.joints[joint].position_rad);
            residual.extend_from_slice(&residuals[joint]);
        }
        let (low, high) = angles.iter().fold((f64::MAX, f64::MIN), |(l, h), q| (l.min(*q), h.max(*q)));
        let range = high - low;
        if !range.is_finite() || range < 0.05 {
            continue;
        }
        // Orders below two turns of phase over the range are springs and gravity, not ripple.
        let lowest = (2.0 * std::f64::consts::TAU / range).max(1.0);
        let step = (0.5 * std::f64::consts::PI / range).min(1.0);
        let stride = (angles.len() / 4000).max(1);
        let count = ((HIGHEST_ORDER - lowest) / step).max(0.0) as usize;
        let power: Vec<f64> = (0..count)
            .map(|k| {
                let order = lowest + k as f64 * step;
                let (mut s, mut c) = (0.0, 0.0);
                for (q, r) in angles.iter().zip(&residual).step_by(stride) {
                    let (sin, cos) = (order * q).sin_cos();
                    s += r * sin;
                    c += r * cos;
                }
                s.hypot(c)
            })
            .collect();
        let mut peaks: Vec<usize> = (0..count)
            .filter(|k| {
                let here = power[*k];
                (*k == 0 || power[k - 1] <= here) && (k + 1 == count || power[k + 1] < here)
            })
            .collect();
        peaks.sort_by(|a, b| power[*b].total_cmp(&power[*a]));
        found.extend(peaks.iter().take(PEAKS).map(|k| (joint, rounded(lowest + *k as f64 * step, step))));
    }
    found
}

/// Gears repeat a whole number of times per turn; where the resolution allows no other whole number, it is that.
fn rounded(order: f64, step: f64) -> f64 {
    let whole = order.round();
    if (order - whole).abs() <= step.min(0.45) { whole } else { order }
}
