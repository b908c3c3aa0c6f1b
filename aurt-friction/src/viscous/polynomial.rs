//! `polynomial`: viscous friction as a sum of odd powers of velocity.
//!
//! # Equation
//! f_v(q̇) = Σ_{i ∈ S} F_v,i b_i(q̇) with b_i = |q̇| q̇^(i−1) for even i and q̇^i for odd i,
//! which for both is q̇ |q̇|^(i−1).
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `powers` | – | S: distinct integers from 1 to 20; an empty list is no viscous friction |
//!
//! # Use when
//! `[1]` always; more powers where friction is curved against velocity and the calibration covers the velocities
//! that the model is to predict: a cubic term beyond them is off by its own size. `saturating` describes the
//! concave friction of harmonic drives with bounded extrapolation.
//!
//! # Source
//! Madsen et al. (2022), equation (8).

use aurt_traits::{Columns, JointModel, JointSeries, ModelError, Parameter, Result, register_model};
use serde::{Deserialize, Serialize};

/// Viscous friction as a sum of odd powers of velocity.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Polynomial {
    /// The powers S, distinct and positive, in the order of the columns.
    pub powers: Vec<u32>,
}

/// Beyond this power a column overflows or vanishes at ordinary joint velocities.
const LARGEST_POWER: u32 = 20;

register_model! {
    slot: Viscous,
    model: Polynomial,
    name: "polynomial",
    summary: "odd powers of velocity",
    equation: "f_v = Σ_{i ∈ powers} F_v,i q̇ |q̇|^(i−1)",
    use_when: "powers = [1] always; more where friction is curved and calibration covers the velocities to be \
               predicted",
    source: "Madsen et al. (2022), equation (8)",
    example: r#"{ model = "polynomial", powers = [1, 2, 3] }"#,
}

impl JointModel for Polynomial {
    declares! {
        invariants: [OddInVelocity, ContinuousInVelocity, SignOfVelocity, Passive, Memoryless],
        reads_load: false,
    }

    fn columns(&self) -> Vec<Parameter> {
        let unit = |i: u32| if i == 1 { "Nm s/rad".to_owned() } else { format!("Nm (s/rad)^{i}") };
        self.powers.iter().map(|i| Parameter::new(format!("F_v{i}"), unit(*i))).collect()
    }

    fn validate(&self) -> Result<(), Vec<ModelError>> {
        let mut complaints = Vec::new();
        let mut complain = |reason: String| {
            complaints.push(ModelError::parameter(Self::NAME, "powers", reason));
        };
        for (k, power) in self.powers.iter().enumerate() {
            if *power == 0 {
                complain("must be positive integers; 0 is a constant and no friction".into());
            }
            if *power > LARGEST_POWER {
                complain(format!("must not exceed {LARGEST_POWER}, contain {power}"));
            }
            if self.powers[..k].contains(power) {
                complain(format!("must be distinct, contain {power} twice"));
            }
        }
        if complaints.is_empty() { Ok(()) } else { Err(complaints) }
    }

    fn evaluate(&self, series: &JointSeries<'_>, _state: &mut [f64], out: &mut Columns<'_>) -> Result {
        for (k, power) in self.powers.iter().enumerate() {
            let column = out.column_mut(k);
            match power {
                1 => column.copy_from_slice(series.velocity_rad_s),
                _ => {
                    let exponent = power.saturating_sub(1) as i32;
                    for (o, v) in column.iter_mut().zip(series.velocity_rad_s) {
                        *o = v * v.abs().powi(exponent);
                    }
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_follow_equation_8_literally() {
        let model = Polynomial { powers: vec![1, 2, 3, 4] };
        let velocity = [-1.7, -0.2, 0.0, 0.4, 2.1];
        let zeros = [0.0; 5];
        let series = JointSeries {
            time_s: &zeros,
            position_rad: &zeros,
            velocity_rad_s: &velocity,
            acceleration_rad_s2: &zeros,
            load_torque: &zeros,
        };
        let mut data = vec![0.0; 20];
        let mut out = Columns::new(&mut data, 4, 5, 5);
        model.evaluate(&series, &mut [], &mut out).unwrap();
        for (n, v) in velocity.iter().enumerate() {
            let literal = [*v, v.abs() * v, v * v * v, v.abs() * v * v * v];
            for (k, expected) in literal.iter().enumerate() {
                assert!((out.column(k)[n] - expected).abs() <= 1e-15 * expected.abs(), "power {}", k + 1);
            }
        }
    }

    #[test]
    fn every_wrong_power_is_reported() {
        let complaints = Polynomial { powers: vec![0, 2, 2, 30] }.validate().unwrap_err();
        let text: Vec<_> = complaints.iter().map(ToString::to_string).collect();
        assert_eq!(text.len(), 3, "{text:?}");
        assert!(text[1].contains("2 twice") && text[2].contains("30"), "{text:?}");
        assert!(Polynomial { powers: Vec::new() }.validate().is_ok());
    }
}
