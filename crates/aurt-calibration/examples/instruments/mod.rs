//! Instrumental variables: rows of the regressor along another motion, whose noise is not that of the recorded one.

use aurt_calibration::{NamedRecording, for_each_row_block, noise_bandwidth_factor};
use aurt_traits::{LoadTorque, RobotModel};
use nalgebra::{DMatrix, DVector};

/// 1.96.
const NORMAL_95: f64 = 1.959_963_984_540_054;

/// 95 % intervals of ζ = (ZᵀΩ⁻¹W)⁻¹ ZᵀΩ⁻¹ y, Z the rows along the motions of `instruments`, with the covariance
/// (ZᵀΩ⁻¹W)⁻¹ ZᵀΩ⁻¹Z (WᵀΩ⁻¹Z)⁻¹ of noise that is white before the parallel filter (Janot, Vandanjon and Gautier 2014).
#[must_use]
pub fn with_instruments(
    model: &RobotModel,
    recordings: &[NamedRecording],
    instruments: &[NamedRecording],
    sigma: &[f64],
) -> Vec<[f64; 2]> {
    let n = model.parameters().len();
    let [mut between, mut own] = [(); 2].map(|()| DMatrix::<f64>::zeros(n, n));
    let mut right = DVector::<f64>::zeros(n);
    let mut bandwidth = 1.0;
    for (recording, instrument) in recordings.iter().zip(instruments) {
        for (seen, other) in recording.data.segments.iter().zip(&instrument.data.segments) {
            bandwidth = noise_bandwidth_factor(&seen.parallel_filter, seen.decimation);
            let measurement = seen.measurement.as_ref().unwrap();
            let [w, z] = [seen, other].map(|segment| {
                let mut slots = vec![Vec::new(); model.slots()];
                let block = |block: aurt_calibration::RowBlock<'_>| {
                    slots.iter_mut().enumerate().for_each(|(s, all)| all.extend_from_slice(block.column(s)));
                };
                for_each_row_block(model, segment, &LoadTorque::Literal, block).unwrap();
                slots
            });
            for (joint, y) in measurement.iter().enumerate() {
                let dot = |a: &[f64], b: &[f64]| -> f64 {
                    a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / (sigma[joint] * sigma[joint])
                };
                let columns: Vec<(usize, usize)> =
                    model.row_slots(joint).zip(model.row_columns(joint).iter().copied()).collect();
                for (slot, row) in &columns {
                    right[*row] += dot(&z[*slot], y);
                    for (other, column) in &columns {
                        between[(*row, *column)] += dot(&z[*slot], &w[*other]);
                        own[(*row, *column)] += dot(&z[*slot], &z[*other]);
                    }
                }
            }
        }
    }
    let inverse = between.try_inverse().unwrap();
    let coefficients = &inverse * right;
    let covariance = &inverse * own * inverse.transpose() * bandwidth;
    (0..n)
        .map(|k| {
            let half = NORMAL_95 * covariance[(k, k)].sqrt();
            [coefficients[k] - half, coefficients[k] + half]
        })
        .collect()
}
