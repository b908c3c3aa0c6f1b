//! Selection with a null that is known.

use crate::evidence::problem::Problem;
use crate::hypotheses::group::{Group, Switch};
use crate::request::SelectionOptions;
use crate::search::ground::{Beside, Ground, Recorded};

/// The rows of a trial, with the scores that chance reaches on the recordings as they are: what is left of a trial once its
/// effect is in the model is what is left of these.
pub(super) struct KnownChance<'a, 'b> {
    pub(super) recorded: Recorded<'b>,
    pub(super) chance: &'a [f64],
}

impl Ground for KnownChance<'_, '_> {
    fn problem(&self) -> &Problem {
        self.recorded.problem()
    }

    fn independent_shares(&self, switches: &[Switch], coefficients: &[f64]) -> Vec<f64> {
        self.recorded.independent_shares(switches, coefficients)
    }

    fn scores_by_chance(&self, _: &[Group], _: &[Switch], _: &[f64], _: &SelectionOptions) -> Vec<f64> {
        self.chance.to_vec()
    }

    fn estimate(&mut self, group: &Group, beside: &Beside<'_>) -> bool {
        self.recorded.estimate(group, beside)
    }
}
