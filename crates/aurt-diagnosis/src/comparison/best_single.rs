//! Every candidate alone.

use rayon::prelude::*;

use crate::evidence::baseline::weighted_fit;
use crate::investigation::Investigation;

/// The group with the lowest Σ_j log MSE_j on held-out blocks, if it is lower than without.
pub(super) fn select(investigation: &Investigation) -> Option<usize> {
    let problem = &investigation.problem;
    let (_, weights) = weighted_fit(problem, &investigation.base_switches, &investigation.floor);
    let nested = problem.nest(&investigation.base_switches, &weights);
    let error = |group: &[crate::hypotheses::group::Switch]| -> f64 {
        let [calibration, target] = problem.held_out(&nested, group);
        (0..problem.joints())
            .map(|j| {
                let rows = problem.rows(j, false).max(1.0);
                rows * ((calibration[j] + target[j]) / rows).max(f64::MIN_POSITIVE).ln()
            })
            .sum()
    };
    let without = error(&[]);
    investigation
        .groups
        .par_iter()
        .enumerate()
        .map(|(k, group)| (k, error(&group.switches)))
        .filter(|(_, e)| *e < without)
        .min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)))
        .map(|(k, _)| k)
}
