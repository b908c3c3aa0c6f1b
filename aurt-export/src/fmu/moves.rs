//! Whether a model can move at all.

use aurt_rbd::{ChainDynamics, SerialChain};

use crate::{ExportError, Source};

/// Positions at which the mass matrix is looked at.
const POSITIONS: u32 = 256;

/// Checks that the mass matrix is positive definite at positions that fill the joints' angles evenly (and prismatic joints'
/// ways of ± π m).
pub(super) fn check(source: &Source<'_>, chain: &SerialChain) -> Result<(), ExportError> {
    let joints = chain.joints().len();
    let mut bodies = ChainDynamics::new(chain.clone(), &source.bodies(|k| source.coefficients[k])?)?
        .with_rotor_inertia(&source.rotor_inertia_kg_m2())?;
    let mut matrix = vec![0.0; joints * joints];
    for sample in 0..POSITIONS {
        // Additive recurrence with the generalised golden ratio, after Roberts (2018).
        let q: Vec<f64> = (0..joints)
            .map(|j| {
                let share = (f64::from(sample) * golden(joints).powi(-(j as i32 + 1))).fract();
                std::f64::consts::TAU * share - std::f64::consts::PI
            })
            .collect();
        bodies.mass_matrix(&q, &mut matrix);
        if !positive_definite(&mut matrix, joints) {
            let at: Vec<String> = q.iter().map(|q| format!("{q:.3}")).collect();
            return Err(ExportError::MassMatrix { position: at.join(" ") });
        }
    }
    Ok(())
}

/// The positive solution of x^(d+1) = x + 1.
fn golden(dimensions: usize) -> f64 {
    let mut x = 1.5_f64;
    for _ in 0..64 {
        x = (1.0 + x).powf(1.0 / (dimensions as f64 + 1.0));
    }
    x
}

/// Whether a symmetric matrix has a Cholesky factor, which takes its place.
fn positive_definite(matrix: &mut [f64], n: usize) -> bool {
    for column in 0..n {
        for row in column..n {
            let mut value = matrix[row * n + column];
            for k in 0..column {
                value -= matrix[row * n + k] * matrix[column * n + k];
            }
            if row == column {
                // A NaN is not positive either.
                if value.is_nan() || value <= 0.0 {
                    return false;
                }
                matrix[row * n + column] = value.sqrt();
            } else {
                matrix[row * n + column] = value / matrix[column * n + column];
            }
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matrices_are_told_apart() {
        assert!(positive_definite(&mut [2.0, 1.0, 1.0, 2.0], 2));
        assert!(!positive_definite(&mut [1.0, 2.0, 2.0, 1.0], 2));
        assert!(!positive_definite(&mut [-1.0], 1));
        assert!(!positive_definite(&mut [f64::NAN], 1));
        assert!((golden(1) - 1.618_033_988_75).abs() < 1e-9);
    }
}
