//! Every candidate alone.

use rayon::prelude::*;

use crate::evidence::baseline::weighted_fit;
use crate::evidence::judge::{Judge, quantile};
use crate::hypotheses::group::Switch;
use crate::investigation::Investigation;
use crate::request::Question;

/// The group with the lowest Σ_j n_j log MSE_j on held-out blocks, if chance does not gain as much with the best of all
/// groups on residuals of the baseline that are shifted against the motion, but for one time in twenty.
pub(super) fn select(question: &Question<'_>, investigation: &Investigation) -> Option<usize> {
    let problem = &investigation.problem;
    let base = &investigation.base_switches;
    let (_, weights) = weighted_fit(problem, base, &investigation.floor);
    let nested = problem.nest(base, &weights);
    let errors = |group: &[Switch]| -> Vec<f64> {
        let [calibration, target] = problem.held_out(&nested, group);
        (0..problem.joints())
            .map(|j| (calibration[j] + target[j]) / problem.rows(j, false).max(1.0))
            .collect()
    };
    let gain = |before: &[f64], after: &[f64]| -> f64 {
        let of_joint = |j: usize| {
            let [before, after] = [before[j], after[j]].map(|e| e.max(f64::MIN_POSITIVE));
            problem.rows(j, false) * (before / after).ln()
        };
        (0..problem.joints()).map(of_joint).sum()
    };
    let without = errors(&[]);
    let (best, score) = investigation
        .groups
        .par_iter()
        .enumerate()
        .map(|(k, group)| (k, gain(&without, &errors(&group.switches))))
        .max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)))?;
    let judge = Judge {
        problem,
        groups: &investigation.groups,
        rows: &investigation.rows,
        partition: &investigation.partition,
        layout: &investigation.layout,
        floor: &investigation.floor,
        options: &question.selection,
    };
    let chance = judge.best_by_chance(base, gain);
    (score > quantile(&chance, 1.0 - question.selection.level)).then_some(best)
}
