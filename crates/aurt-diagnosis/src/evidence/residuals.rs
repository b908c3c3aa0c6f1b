//! What a fit leaves of a recording.

use std::collections::BTreeMap;

use crate::hypotheses::group::Switch;
use crate::recordings::partition::Partition;
use crate::recordings::rows::{Layout, RecordingRows, Role, independent_share};

/// Residuals of a fit over one part of a recording, joint by joint.
#[must_use]
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
const LONGEST_MEMORY: usize = 400;

/// Share of independent rows of each joint's residual over what is not for validation.
pub(crate) fn shares(
    rows: &[RecordingRows],
    partition: &Partition,
    layout: &Layout,
    switches: &[Switch],
    coefficients: &[f64],
) -> Vec<f64> {
    let joints = layout.rows.len();
    let mut sum = vec![0.0; joints];
    let mut count = 0.0;
    for (r, recording) in rows.iter().enumerate().filter(|(_, r)| r.role != Role::Validation) {
        let end = partition.fitted().filter(|p| p.0 == r).map(|p| p.2).max().unwrap_or(0);
        let residual = residuals(recording, layout, switches, coefficients);
        for (s, series) in sum.iter_mut().zip(&residual) {
            *s += independent_share(&series[..end], LONGEST_MEMORY) * end as f64;
        }
        count += end as f64;
    }
    sum.iter().map(|s| s / f64::max(count, 1.0)).collect()
}
