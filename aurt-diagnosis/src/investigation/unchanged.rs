//! Errors of an unchanged arm, and those of the targets beside them.

use crate::evidence::between::{Share, taken};
use crate::evidence::deviations::memory;
use crate::evidence::total::TotalFit;
use crate::hypotheses::group::Switch;
use crate::investigation::Investigation;
use crate::investigation::fitted::Fitted;
use crate::investigation::selecting::mean_floor;
use crate::recordings::rows::Role;

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
        let noise = mean_floor(&self.rows, &self.partition, &self.floors, |role| role == Role::Target);
        let of_joint = |(j, left): (usize, f64)| {
            // A joint that never moved beside the targets cannot have changed.
            if total[0][j].rows <= 0.0 {
                return f64::INFINITY;
            }
            let power = |kind: usize| total[kind][j].square / total[kind][j].rows.max(1.0);
            // Of a given model only the residual is here, which does not tell the torque.
            let is_known = !self.baseline.frozen && power(0) > 0.0;
            let louder = if is_known { (power(1) / power(0)).max(1.0) } else { 1.0 };
            (louder * left).max(noise[j])
        };
        left.into_iter().enumerate().map(of_joint).collect()
    }

    /// Mean squares that a model leaves of the targets beside friction that differs as that of an unchanged robot does; `references` are the
    /// variances of noise.
    pub(crate) fn left_in_targets(
        &self,
        fitted: &Fitted,
        switches: &[Switch],
        fit: &TotalFit,
        references: &[f64],
    ) -> Vec<f64> {
        let Self { problem, model, baseline, base_switches, mean_independent_share, .. } = self;
        let own = fitted.own(&baseline.coefficients, base_switches);
        let friction = fitted.between.unwrap_or(Share::USUAL).changes(model, &own);
        let total = problem.total();
        let of_joint = |(joint, friction): (usize, Vec<(Switch, f64)>)| {
            let (columns, deviations): (Vec<Switch>, Vec<f64>) = friction.into_iter().unzip();
            let mut alone = vec![0.0; problem.joints()];
            alone[joint] = 1.0;
            let mut right = problem.right(total, &columns, &alone);
            let products = problem.cross(total, &columns, switches, &alone);
            for (products, value) in products.chunks_exact(columns.len().max(1)).zip(&fit.coefficients) {
                right.iter_mut().zip(products).for_each(|(r, product)| *r -= product * value);
            }
            let gram = problem.cross(total, &columns, &columns, &alone);
            let noise = references[joint] * memory(*mean_independent_share);
            let usual = taken(&gram, &right, noise, &deviations);
            (fit.squared_errors[1][joint] - usual).max(0.0) / total[1][joint].rows.max(1.0)
        };
        friction.into_iter().enumerate().map(of_joint).collect()
    }
}
