//! Coefficients come back from the torque that they made, for every registered model in its place.

use aurt_friction::conformance::arm;
use aurt_friction::conformance::recording::{Draw, Recording};
use aurt_traits::{Columns, JointStack};
use nalgebra::{DMatrix, DVector};

use super::invariants::in_its_slot;
use super::models::{Model, examples};
use super::planar_arm::PlanarArm;

fn stack_columns(stack: &JointStack, recording: &Recording) -> Vec<Vec<f64>> {
    let series = recording.joint(0);
    let (count, samples) = (stack.columns().len(), series.samples());
    let mut data = vec![0.0; count * samples];
    let mut state = stack.initial_state(&series.slice(0..1));
    stack.evaluate(&series, &mut state, &mut Columns::new(&mut data, count, samples, samples)).unwrap();
    data.chunks_exact(samples).map(<[f64]>::to_vec).collect()
}

fn assert_recovered(what: &str, columns: &[Vec<f64>], seed: u64) {
    let mut draw = Draw::new(seed ^ 0x5eed);
    let truth: Vec<f64> = columns.iter().map(|_| draw.between(0.5, 2.0)).collect();
    let torque: Vec<f64> =
        (0..columns[0].len()).map(|n| columns.iter().zip(&truth).map(|(c, x)| x * c[n]).sum()).collect();
    // Columns of unit length, so that their dependence shows in the triangle.
    let lengths: Vec<f64> = columns.iter().map(|c| c.iter().map(|x| x * x).sum::<f64>().sqrt()).collect();
    let scaled = DMatrix::from_fn(torque.len(), columns.len(), |n, k| columns[k][n] / lengths[k]);
    let (orthogonal, triangle) = scaled.qr().unpack();
    let independent = triangle.diagonal().iter().all(|d| d.abs() > 1e-9);
    assert!(independent, "{what}: the columns depend on each other");
    let found = triangle.solve_upper_triangular(&orthogonal.tr_mul(&DVector::from_vec(torque))).unwrap();
    let found: Vec<f64> = found.iter().zip(&lengths).map(|(x, length)| x / length).collect();
    for (k, (x, expected)) in found.iter().zip(&truth).enumerate() {
        assert!((x - expected).abs() < 1e-6 * expected, "{what}, coefficient {k}: {x} for {expected}");
    }
}

#[test]
fn joint_coefficients_come_back() {
    for (entry, model) in examples() {
        if matches!(model, Model::Arm(_)) {
            continue;
        }
        for seed in 0..4 {
            let stack = in_its_slot(&model).unwrap();
            assert_recovered(entry.name, &stack_columns(&stack, &Recording::random(seed, 1, 3_000)), seed);
        }
    }
}

#[test]
fn arm_coefficients_come_back() {
    let body = PlanarArm::new(6);
    for (entry, model) in examples() {
        let Model::Arm(term) = model else { continue };
        let count = term.columns(6).len();
        for seed in 0..4 {
            let rows = arm::evaluate(&*term, &body, &Recording::random(seed, 6, 1_000), &[]).unwrap();
            let mut columns: Vec<Vec<f64>> =
                (0..count).map(|k| rows.iter().skip(k).step_by(count).flatten().copied().collect()).collect();
            // A planar arm does not feel a first moment along its axes.
            columns.retain(|c| entry.name != "payload" || c.iter().any(|x| *x != 0.0));
            assert_recovered(entry.name, &columns, seed);
        }
    }
}
