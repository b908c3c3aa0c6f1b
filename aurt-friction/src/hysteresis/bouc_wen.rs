//! `bouc_wen`: smooth hysteresis with a shape of its own for loading and unloading.
//!
//! # Equation
//! dH/dq = (1 − |H|ⁿ (γ + β sgn(H q̇)))/p with γ = 1 − β, so that |H| → 1 in sliding.
//!
//! In the usual notation ż = A q̇ − β |q̇| |z|ⁿ⁻¹ z − γ q̇ |z|ⁿ with A = 1/p and β, γ scaled by it. β ≥ ½ (that is,
//! β ≥ |γ|) is the condition for a loop that never gives energy.
//!
//! Between two samples the path is taken as monotone. The equation is integrated along the distance with the
//! classical Runge–Kutta method in substeps of at most p/16; the zero of H, where its derivative has a kink, and
//! sliding, where nothing changes, are treated apart. The error in H stays below 10⁻⁵ (10⁻⁶ for n = 1 and
//! n = 2); only positions enter, no times.
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `presliding_rad` | rad | p, shape, 10⁻⁵–0.5, searched in logarithms; 0.01 unless given |
//! | `exponent` | 1 | n, shape, 1–4: sharpness of the transition to sliding; 1 unless given |
//! | `beta` | 1 | β, shape, 0.5–1: 0.5 unloads along a straight line, 1 with n = 1 is `dahl`; 0.5 unless given |
//!
//! # State
//! H and the previous position; H = 0 at the first sample of a series.
//!
//! # Use when
//! The loop's transition is sharper than Dahl's exponential and one column is wanted. `maxwell_slip` fits any
//! transition with linear coefficients.
//!
//! # Source
//! Bouc (1967); Wen (1976), *Method for random vibration of hysteretic systems*; Erlicher and Point (2004),
//! *Thermodynamic admissibility of Bouc–Wen type hysteresis models*, for the condition on β.

use aurt_traits::{Columns, JointModel, JointSeries, Result, register_model};
use serde::{Deserialize, Serialize};

use crate::hysteresis::dahl::PRESLIDING;
use crate::shape::Shape;

const EXPONENT: Shape = Shape::linear("exponent", "1", 1.0, 4.0);
const BETA: Shape = Shape::linear("beta", "1", 0.5, 1.0);

/// Longest substep, relative to the presliding distance.
const SUBSTEP: f64 = 1.0 / 16.0;
/// From here on H counts as sliding.
const SLIDING: f64 = 1.0 - 1e-12;

/// The Bouc–Wen model, normalised.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BoucWen {
    /// Presliding distance p in rad.
    pub presliding_rad: f64,
    /// Exponent n.
    pub exponent: f64,
    /// Share β of the dissipating term.
    pub beta: f64,
}

impl Default for BoucWen {
    fn default() -> Self {
        Self { presliding_rad: 0.01, exponent: 1.0, beta: 0.5 }
    }
}

impl BoucWen {
    fn power(&self, x: f64) -> f64 {
        if self.exponent == 1.0 { x } else { libm::pow(x, self.exponent) }
    }

    /// The slope of `along`, the force in the direction of motion, against the distance in units of p.
    fn slope(&self, along: f64) -> f64 {
        if along >= 0.0 {
            1.0 - self.power(along)
        } else {
            1.0 + (2.0 * self.beta - 1.0) * self.power(-along)
        }
    }

    /// The distance, in units of p, in which a small opposing force `against` > 0 falls to zero.
    fn distance_to_zero(&self, against: f64) -> f64 {
        // Three-point Gauss–Legendre quadrature of 1/slope over 0 … against.
        let node = 0.6_f64.sqrt() / 2.0;
        let inverse = |share: f64| 1.0 / self.slope(-against * share);
        against * (5.0 * inverse(0.5 - node) + 8.0 * inverse(0.5) + 5.0 * inverse(0.5 + node)) / 18.0
    }

    /// The force in the direction of motion after `distance`, in units of p.
    fn advance(&self, mut along: f64, mut distance: f64) -> f64 {
        while distance > 0.0 && along < SLIDING {
            let mut step = distance.min(SUBSTEP);
            if along < 0.0 && -along <= 2.0 * SUBSTEP {
                // The slope lies between one and two here: within the reach of a step, zero is met exactly.
                let to_zero = self.distance_to_zero(-along);
                if to_zero <= distance {
                    along = 0.0;
                    distance -= to_zero;
                    continue;
                }
                step = distance;
            }
            let k1 = self.slope(along);
            let k2 = self.slope(along + 0.5 * step * k1);
            let k3 = self.slope(along + 0.5 * step * k2);
            let k4 = self.slope(along + step * k3);
            along = (along + step * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0).min(1.0);
            distance -= step;
        }
        along
    }
}

register_model! {
    slot: Hysteresis,
    model: BoucWen,
    name: "bouc_wen",
    summary: "smooth hysteresis with adjustable sharpness and unloading",
    equation: "dH/dq = (1 − |H|^n (1 − β + β sgn(H q̇)))/presliding_rad, n = exponent, β = beta",
    use_when: "the transition to sliding is sharper than `dahl`'s and one column is wanted",
    source: "Bouc (1967); Wen (1976); Erlicher and Point (2004)",
    example: r#"{ model = "bouc_wen", presliding_rad = 0.01, exponent = 1.0, beta = 0.5 }"#,
}

impl JointModel for BoucWen {
    declares! {
        columns: ["bouc_wen" in "1"],
        invariants: [BoundedByOne, OddInVelocity, ContinuousInVelocity, Passive, RateIndependent],
        reads_load: false,
        shape: [presliding_rad in PRESLIDING, exponent in EXPONENT, beta in BETA],
        validate: within_bounds,
    }

    fn state_len(&self) -> usize {
        2
    }

    fn initial_state(&self, first: &JointSeries<'_>) -> Vec<f64> {
        vec![0.0, first.position_rad[0]]
    }

    fn evaluate(&self, series: &JointSeries<'_>, state: &mut [f64], out: &mut Columns<'_>) -> Result {
        let (mut h, mut position) = (state[0], state[1]);
        for (o, q) in out.column_mut(0).iter_mut().zip(series.position_rad) {
            let dq = q - position;
            let direction = dq.signum();
            h = self.advance(h * direction, dq.abs() / self.presliding_rad) * direction;
            position = *q;
            *o = h;
        }
        (state[0], state[1]) = (h, position);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The closed solution for n = 1.
    fn exponential(along: f64, distance: f64, beta: f64) -> f64 {
        let k = 2.0 * beta - 1.0;
        if along >= 0.0 {
            return 1.0 - (1.0 - along) * libm::exp(-distance);
        }
        let to_zero = if k == 0.0 { -along } else { libm::log(1.0 - k * along) / k };
        if distance >= to_zero {
            return 1.0 - libm::exp(to_zero - distance);
        }
        if k == 0.0 { along + distance } else { (1.0 - (1.0 - k * along) * libm::exp(-k * distance)) / k }
    }

    /// The closed solution for n = 2.
    fn hyperbolic(along: f64, distance: f64, beta: f64) -> f64 {
        let k = (2.0 * beta - 1.0).sqrt();
        if along >= 0.0 {
            return libm::tanh(libm::atanh(along) + distance);
        }
        let to_zero = if k == 0.0 { -along } else { libm::atan(-k * along) / k };
        if distance >= to_zero {
            return libm::tanh(distance - to_zero);
        }
        if k == 0.0 { along + distance } else { libm::tan(libm::atan(k * along) + k * distance) / k }
    }

    fn largest_error(exponent: f64, reference: impl Fn(f64, f64, f64) -> f64) -> f64 {
        let mut worst = 0.0_f64;
        for beta in [0.5, 0.7, 1.0] {
            let model = BoucWen { presliding_rad: 1.0, exponent, beta };
            for i in 0..40 {
                for distance in [0.003, 0.05, 0.11, 0.7, 1.9, 6.0, 50.0] {
                    let along = -0.995 + 0.05 * f64::from(i);
                    let error = model.advance(along, distance) - reference(along, distance, beta);
                    worst = worst.max(error.abs());
                }
            }
        }
        worst
    }

    #[test]
    fn integration_error_is_as_stated() {
        assert!(largest_error(1.0, exponential) < 1e-6, "{:e}", largest_error(1.0, exponential));
        assert!(largest_error(2.0, hyperbolic) < 1e-6, "{:e}", largest_error(2.0, hyperbolic));
    }

    #[test]
    fn integration_error_is_as_stated_for_broken_exponents() {
        // The reference is the same equation in steps five hundred times smaller, by Heun's method.
        for exponent in [1.1, 1.3, 1.5, 1.8, 2.5, 4.0] {
            let reference = |mut along: f64, distance: f64, beta: f64| {
                let model = BoucWen { presliding_rad: 1.0, exponent, beta };
                let count = (distance / 1e-4).ceil().min(2e5);
                let step = distance / count;
                for _ in 0..count as usize {
                    let slope = model.slope(along);
                    along += 0.5 * step * (slope + model.slope(along + step * slope));
                }
                along
            };
            let mut worst = 0.0_f64;
            for (along, distance, beta) in
                [(-0.9, 1.4, 0.5), (-0.9, 0.6, 1.0), (0.0, 0.05, 0.5), (-0.05, 0.3, 0.7), (-0.5, 3.0, 0.8)]
            {
                let model = BoucWen { presliding_rad: 1.0, exponent, beta };
                worst = worst.max((model.advance(along, distance) - reference(along, distance, beta)).abs());
            }
            assert!(worst < 1e-5, "exponent {exponent}: {worst:e}");
        }
    }
}
