use num_complex::Complex64 as Complex;

use std::f64::consts::PI;

/// A second-order section in the usual notation,
/// H(z) = (b₀ + b₁z⁻¹ + b₂z⁻²) / (1 + a₁z⁻¹ + a₂z⁻²).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    /// Numerator coefficients b₀, b₁, b₂.
    pub b: [f64; 3],
    /// Denominator coefficients a₁, a₂ (a₀ is 1).
    pub a: [f64; 2],
}

/// A digital Butterworth low-pass: the analogue prototype with its poles on the circle of the pre-warped
/// cut-off, carried over by the bilinear transform.
///
/// The same filter as `scipy.signal.butter(order, wn, output="sos")`, section by section: the most damped
/// poles come first and the overall gain stands in the first section. With an odd order the first section has
/// a₂ = 0 (the real pole) and one section has b₂ = 0.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Butterworth {
    pub(crate) sections: Vec<Section>,
    /// Poles with Im p ≥ 0, the most damped first; a real pole has Im p = 0.
    pub(crate) poles: Vec<Complex>,
    /// The filter's value at z → ∞, so its numerator is `gain` (1 + z⁻¹)^order.
    pub(crate) gain: f64,
    pub(crate) order: usize,
}

impl Butterworth {
    /// The low-pass of the given order whose gain is 1/√2 at `normalized_cutoff` times the Nyquist frequency;
    /// `normalized_cutoff` lies strictly between 0 and 1.
    pub(crate) fn low_pass(order: usize, normalized_cutoff: f64) -> Self {
        // The transform is written for a sampling rate of 2, in units of the Nyquist frequency.
        let twice_rate = 4.0;
        let warped = twice_rate * libm::tan(PI * normalized_cutoff / 2.0);
        // Angles from the negative real axis, largest damping first; each stands for a conjugate pair but 0.
        let first = if order % 2 == 1 { 0 } else { 1 };
        let mut poles = Vec::with_capacity(order.div_ceil(2));
        let mut gain = 1.0;
        for step in (first..order).step_by(2) {
            let angle = PI * step as f64 / (2 * order) as f64;
            let analogue = Complex::new(-libm::cos(angle) * warped, libm::sin(angle) * warped);
            let denominator = Complex::from(twice_rate) - analogue;
            poles.push((Complex::from(twice_rate) + analogue) / denominator);
            gain *=
                if step == 0 { warped / denominator.re } else { warped * warped / denominator.norm_sqr() };
        }
        // An odd order has one zero at the origin more than sections have use for; scipy gives it to the least
        // damped section whose poles it is nearer to than to the zeros at −1.
        let odd = order % 2 == 1;
        let short = poles.iter().rposition(|p| p.re > -0.5).unwrap_or(0);
        let sections = poles
            .iter()
            .enumerate()
            .map(|(k, pole)| {
                let scale = if k == 0 { gain } else { 1.0 };
                let b = if odd && k == short { [scale, scale, 0.0] } else { [scale, 2.0 * scale, scale] };
                let a = if odd && k == 0 { [-pole.re, 0.0] } else { [-2.0 * pole.re, pole.norm_sqr()] };
                Section { b, a }
            })
            .collect();
        Self { sections, poles, gain, order }
    }

    /// Samples by which scipy's `sosfiltfilt` extends a series at both ends: 3 · (2·sections + 1), less 3 for
    /// an odd order.
    pub(crate) fn padding(&self) -> usize {
        3 * (2 * self.sections.len() + 1 - self.order % 2)
    }

    /// Samples after which every transient has decayed by the factor `relative`.
    pub(crate) fn decay_samples(&self, relative: f64) -> usize {
        let slowest = self.poles.iter().map(|p| p.norm_sqr().sqrt()).fold(0.0, f64::max);
        // The poles lie inside the unit circle, but for absurdly low cut-offs rounding may put them on it.
        (libm::log(relative) / libm::log(slowest.min(1.0 - f64::EPSILON))).ceil().max(1.0) as usize
    }
}
