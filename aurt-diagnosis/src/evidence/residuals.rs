//! What a fit leaves of a recording.

use std::collections::BTreeMap;

use crate::hypotheses::group::Switch;
use crate::recordings::partition::Partition;
use crate::recordings::rows::{Layout, RecordingRows, Role, independent_share};

/// Residuals of a fit over one part of a recording, joint by joint.
pub fn residuals(
    recording: &RecordingRows,
    layout: &Layout,
    switches: &[Switch],
    coefficients: &[f64],
) -> Vec<Vec<f64>> {
    let target = recording.role != Role::Calibration;
    let mut dense: BTreeMap<usize, f64> = BTreeMap::new();
    for (switch, value) in switches.iter().zip(coefficients) {
        if target || !switch.target_only {
            *dense.entry(switch.column).or_default() += value;
        }
    }
    recording
        .joints
        .iter()
        .enumerate()
        .map(|(j, joint)| joint.residual(layout.rows[j].iter().map(|c| dense.get(c).copied().unwrap_or(0.0))))
        .collect()
}

/// Lags over which a residual's memory is followed, in rows.
pub(crate) const LONGEST_MEMORY: usize = 400;

/// Share of independent rows of each joint's residual over what is not for validation.
pub(crate) fn shares(
    rows: &[RecordingRows],
    partition: &Partition,
    layout: &Layout,
    switches: &[Switch],
    coefficients: &[f64],
) -> Vec<f64> {
    (0..layout.rows.len()).map(|j| share(rows, partition, layout, j, switches, coefficients)).collect()
}

/// [`shares`] of one joint.
pub(crate) fn share(
    rows: &[RecordingRows],
    partition: &Partition,
    layout: &Layout,
    joint: usize,
    switches: &[Switch],
    coefficients: &[f64],
) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (r, recording) in rows.iter().enumerate().filter(|(_, r)| r.role != Role::Validation) {
        let target = recording.role != Role::Calibration;
        let end = partition.fitted().filter(|p| p.0 == r).map(|p| p.2).max().unwrap_or(0);
        let value = |column: &usize| -> f64 {
            let of = switches.iter().zip(coefficients);
            of.filter(|(s, _)| s.column == *column && (target || !s.target_only)).map(|(_, v)| v).sum()
        };
        let residual = recording.joints[joint].residual(layout.rows[joint].iter().map(value));
        sum += independent_share(&residual[..end], LONGEST_MEMORY) * end as f64;
        count += end as f64;
    }
    sum / f64::max(count, 1.0)
}
