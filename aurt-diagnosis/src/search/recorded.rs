//! Selection on the rows of recordings.

use crate::evidence::baseline::weighted_fit;
use crate::evidence::chance::Chance;
use crate::evidence::judge::Judge;
use crate::evidence::problem::Problem;
use crate::evidence::residuals::shares;
use crate::hypotheses::group::{Group, Switch};
use crate::recordings::rows::mean_rate_hz;
use crate::request::SelectionOptions;
use crate::search::ground::{Beside, Ground, Recorded};
use crate::search::shapes::Estimate;

impl Ground for Recorded<'_> {
    fn problem(&self) -> &Problem {
        &self.problem
    }

    fn independent_shares(&self, switches: &[Switch], coefficients: &[f64]) -> Vec<f64> {
        shares(self.rows, self.partition, self.layout, switches, coefficients)
    }

    fn rows_per_s(&self) -> f64 {
        mean_rate_hz(self.rows)
    }

    fn scores_by_chance(
        &self,
        groups: &[Group],
        switches: &[Switch],
        floor: &[f64],
        options: &SelectionOptions,
    ) -> Chance {
        let (rows, partition, layout) = (&*self.rows, self.partition, self.layout);
        let judge = Judge { problem: &self.problem, groups, rows, partition, layout, floor, options };
        let (fit, _) = weighted_fit(&self.problem, switches, floor);
        judge.scores_by_chance(switches, &self.independent_shares(switches, &fit.coefficients))
    }

    fn estimate(&mut self, group: &Group, beside: &Beside<'_>) -> bool {
        if self.candidates[group.candidate].proposal.shapes.is_empty() {
            return false;
        }
        Estimate::new(self, group, beside).is_some_and(Estimate::run)
    }
}
