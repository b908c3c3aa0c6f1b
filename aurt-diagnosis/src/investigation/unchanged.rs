//! What the model of an unchanged arm leaves.

use crate::evidence::total::TotalFit;
use crate::hypotheses::group::Switch;
use crate::investigation::Investigation;

impl Investigation {
    /// Mean squares that a model leaves of each joint beside the targets: what the targets keep bends a fit to both, so that it is no more
    /// than what the same model leaves that is fitted to these recordings alone, with the degrees of freedom given back that this fit
    /// takes.
    pub(crate) fn left_beside_targets(&self, switches: &[Switch], fit: &TotalFit) -> Vec<f64> {
        let Self { problem, baseline, floor, mean_independent_share, .. } = self;
        let rows = |j: usize| problem.total()[0][j].rows;
        let per_row = |errors: &[f64], j: usize| errors[j] / rows(j).max(1.0);
        let both = (0..floor.len()).map(|j| per_row(&fit.squared_errors[0], j));
        if baseline.frozen || self.undetermined || !problem.has_reference() {
            return both.collect();
        }
        let in_all = switches.iter().filter(|s| !s.target_only).count();
        let freedoms = in_all as f64 / problem.joints() as f64;
        let alone = problem.reference_errors(switches, &problem.weights(&fit.squared_errors, floor));
        let given_back = |j: usize| {
            let independent = mean_independent_share * rows(j);
            if independent > freedoms { independent / (independent - freedoms) } else { f64::INFINITY }
        };
        both.enumerate().map(|(j, both)| both.min(per_row(&alone, j) * given_back(j))).collect()
    }

    /// Mean squares that a model leaves of an unchanged arm in the targets' motion: what it leaves of the recordings beside them, as much
    /// larger as the torque is, and no less than noise. A wrong structure errs in proportion to the torque.
    pub(crate) fn usual_errors(&self, switches: &[Switch], fit: &TotalFit) -> Vec<f64> {
        let total = self.problem.total();
        let left = self.left_beside_targets(switches, fit);
        let of_joint = |(j, left): (usize, f64)| {
            // What never moved beside the targets has nothing that it could have changed from.
            if total[0][j].rows <= 0.0 {
                return f64::INFINITY;
            }
            let power = |kind: usize| total[kind][j].square / total[kind][j].rows.max(1.0);
            // What a given model leaves is no measure of the torque.
            let is_known = !self.baseline.frozen && power(0) > 0.0;
            let louder = if is_known { (power(1) / power(0)).max(1.0) } else { 1.0 };
            (louder * left).max(self.floor[j])
        };
        left.into_iter().enumerate().map(of_joint).collect()
    }
}
