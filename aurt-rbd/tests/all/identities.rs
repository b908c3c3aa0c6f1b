//! Identities between independent formulations, on random robots.

use crate::robots;

use aurt_rbd::{ChainDynamics, base_parameters};
use aurt_traits::RigidBodyRegressor;
use proptest::prelude::*;

/// Whether two vectors agree to `tolerance`, relative to the larger of their sizes and `scale`.
fn close(a: &[f64], b: &[f64], tolerance: f64, scale: f64) -> Result<(), TestCaseError> {
    let size = a.iter().chain(b).fold(scale, |m, v| m.max(v.abs()));
    for (i, (x, y)) in a.iter().zip(b).enumerate() {
        prop_assert!((x - y).abs() <= tolerance * size, "entry {i}: {x} and {y} (size {size})");
    }
    Ok(())
}

fn times(matrix: &[f64], vector: &[f64]) -> Vec<f64> {
    matrix.chunks_exact(vector.len()).map(|row| row.iter().zip(vector).map(|(a, b)| a * b).sum()).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn regressor_times_parameters_is_newton_euler((chain, standard, [q, qd, qdd]) in robots::any_robot()) {
        let product = times(&chain.regressor(&q, &qd, &qdd), &standard);
        let mut torque = vec![0.0; q.len()];
        ChainDynamics::new(chain, &standard).unwrap().inverse_dynamics(&q, &qd, &qdd, &mut torque);
        close(&product, &torque, 1e-12, 1.0)?;
    }

    #[test]
    fn forward_dynamics_inverts_newton_euler(
        (chain, standard, [q, qd, qdd]) in robots::any_robot(),
        rotors in prop::collection::vec(0.0..0.5, 12),
    ) {
        let n = q.len();
        let mut dynamics =
            ChainDynamics::new(chain, &standard).unwrap().with_rotor_inertia(&rotors[..n]).unwrap();
        let mut torque = vec![0.0; n];
        let mut again = vec![0.0; n];
        dynamics.inverse_dynamics(&q, &qd, &qdd, &mut torque);
        dynamics.forward_dynamics(&q, &qd, &torque, &mut again);
        close(&qdd, &again, 1e-8, 1.0)?;

        let mut mass = vec![0.0; n * n];
        let mut bias = vec![0.0; n];
        dynamics.mass_matrix(&q, &mut mass);
        dynamics.bias_torque(&q, &qd, &mut bias);
        let sum: Vec<f64> = times(&mass, &qdd).iter().zip(&bias).map(|(a, b)| a + b).collect();
        close(&torque, &sum, 1e-12, 1.0)?;
    }

    /// dE/dt = q̇ᵀ τ, with dE/dt by central differences along the motion, and ½ q̇ᵀ M q̇ is the kinetic energy.
    #[test]
    fn power_is_the_rate_of_energy((chain, standard, [q, qd, qdd]) in robots::any_robot()) {
        let n = q.len();
        let rotors = vec![0.1; n];
        let mut dynamics =
            ChainDynamics::new(chain, &standard).unwrap().with_rotor_inertia(&rotors).unwrap();
        let h = 1e-4;
        let mut energy_at = |t: f64| {
            let position: Vec<f64> = (0..n).map(|j| q[j] + t * (qd[j] + 0.5 * t * qdd[j])).collect();
            let velocity: Vec<f64> = (0..n).map(|j| qd[j] + t * qdd[j]).collect();
            dynamics.energy(&position, &velocity).total_j()
        };
        // Fourth-order central difference.
        let rate = (8.0 * (energy_at(h) - energy_at(-h)) - (energy_at(2.0 * h) - energy_at(-2.0 * h))) / (12.0 * h);
        let kinetic = dynamics.energy(&q, &qd).kinetic_j;
        let mut torque = vec![0.0; n];
        dynamics.inverse_dynamics(&q, &qd, &qdd, &mut torque);
        let power: f64 = torque.iter().zip(&qd).map(|(a, b)| a * b).sum();
        let size: f64 = torque.iter().zip(&qd).map(|(a, b)| (a * b).abs()).sum();
        // A robot nearly at rest has hardly any power; the difference still rounds as its energy does: 1e-11 of what all its
        // masses have at 20 m under 10 m/s².
        let potential_j = 10.0 * 20.0 * standard.chunks_exact(10).map(|body| body[9]).sum::<f64>();
        close(&[rate], &[power], 1e-7, size + kinetic + 1e-4 * potential_j)?;

        let mut mass = vec![0.0; n * n];
        dynamics.mass_matrix(&q, &mut mass);
        let from_mass: f64 = 0.5 * times(&mass, &qd).iter().zip(&qd).map(|(a, b)| a * b).sum::<f64>();
        close(&[kinetic], &[from_mass], 1e-12, 1.0)?;
    }

    /// The Jacobian's columns are the derivatives of the frames, and Jᵀ F does the work of F.
    #[test]
    fn jacobian_is_the_derivative_of_the_point(
        (chain, _, [q, qd, _]) in robots::any_robot(),
        point in [-0.5..0.5, -0.5..0.5, -0.5..0.5_f64],
    ) {
        let n = q.len();
        let link = n - 1 - n / 3;
        let mut frames = Vec::new();
        chain.link_frames(&q, &mut frames);
        let mut jacobian = vec![0.0; 6 * n];
        chain.jacobian(&frames, link, point, &mut jacobian);
        let velocity = times(&jacobian, &qd);
        let h = 1e-4;
        let mut at = |t: f64| {
            let position: Vec<f64> = q.iter().zip(&qd).map(|(q, qd)| q + t * qd).collect();
            chain.link_frames(&position, &mut frames);
            (frames[link].point_m(point), frames[link].rotation)
        };
        let difference = |a: f64, b: f64, c: f64, d: f64| (8.0 * (a - b) - (c - d)) / (12.0 * h);
        let (now, a, b, c, d) = (at(0.0), at(h), at(-h), at(2.0 * h), at(-2.0 * h));
        for r in 0..3 {
            let rate = difference(a.0[r], b.0[r], c.0[r], d.0[r]);
            prop_assert!((rate - velocity[r]).abs() < 1e-6, "row {r}: {rate} and {}", velocity[r]);
        }
        // Ṙ Rᵀ = [ω]×
        let spin = |i: usize, k: usize| -> f64 {
            (0..3)
                .map(|m| difference(a.1[i][m], b.1[i][m], c.1[i][m], d.1[i][m]) * now.1[k][m])
                .sum()
        };
        for (row, (i, k)) in [(2, 1), (0, 2), (1, 0)].into_iter().enumerate() {
            prop_assert!((spin(i, k) - velocity[3 + row]).abs() < 1e-5);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn base_parameters_give_the_whole_torque((chain, standard, [q, qd, qdd]) in robots::any_robot()) {
        let base = base_parameters(&chain, 7).unwrap();
        let regressor = chain.regressor(&q, &qd, &qdd);
        let values = base.values(&standard);
        let kept: Vec<f64> = regressor
            .chunks_exact(standard.len())
            .flat_map(|row| base.columns.iter().map(|c| row[*c]))
            .collect();
        // Columns that depend on others but for 1e-9 count as dependent: on a robot whose axes nearly meet, the identity
        // holds to what that leaves, summed over the columns.
        close(&times(&kept, &values), &times(&regressor, &standard), 1e-8, 1.0)?;
        for column in 0..standard.len() {
            if (0..q.len()).all(|joint| !chain.loads(column, joint)) {
                prop_assert!(!base.columns.contains(&column));
            }
        }
    }
}
