//! Selection with what is known of the recordings as they are.

use crate::evidence::chance::Chance;
use crate::evidence::problem::Problem;
use crate::evidence::residuals::share;
use crate::hypotheses::group::{Group, Switch};
use crate::request::SelectionOptions;
use crate::search::ground::{Beside, Ground, Recorded};

/// The rows of a trial. What is left of a trial once its effect is in the model is what is left of the recordings as they
/// are: the scores that chance reaches are theirs, and so are the memory of the residual and the shapes of laws on joints
/// whose measurement has not changed.
pub(super) struct Known<'a, 'b> {
    pub(super) recorded: Recorded<'b>,
    /// The scores that chance reaches.
    pub(super) chance: &'a Chance,
    /// Share of independent rows of each joint.
    pub(super) shares: &'a [f64],
    /// Joints whose measurement has changed.
    pub(super) changed: &'a [usize],
}

impl Ground for Known<'_, '_> {
    fn problem(&self) -> &Problem {
        self.recorded.problem()
    }

    fn independent_shares(&self, switches: &[Switch], coefficients: &[f64]) -> Vec<f64> {
        let mut shares = self.shares.to_vec();
        let Recorded { rows, partition, layout, .. } = &self.recorded;
        for joint in self.changed {
            shares[*joint] = share(rows, partition, layout, *joint, switches, coefficients);
        }
        shares
    }

    fn rows_per_s(&self) -> f64 {
        self.recorded.rows_per_s()
    }

    fn scores_by_chance(&self, _: &[Group], _: &[Switch], _: &[f64], _: &SelectionOptions) -> Chance {
        self.chance.clone()
    }

    fn estimate(&mut self, group: &Group, beside: &Beside<'_>) -> bool {
        group.joints.iter().any(|j| self.changed.contains(j))
            && self.recorded.estimate(group, &Beside { deviations: false, ..*beside })
    }
}
