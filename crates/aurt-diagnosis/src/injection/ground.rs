//! Selection with what is known of the recordings as they are.

use crate::evidence::problem::Problem;
use crate::hypotheses::group::{Group, Switch};
use crate::recordings::rows::{Role, independent_share};
use crate::request::SelectionOptions;
use crate::search::ground::{Beside, Ground, Recorded};

/// The rows of a trial. What is left of a trial once its effect is in the model is what is left of the recordings as they
/// are: the scores that chance reaches are theirs, and so are the memory of the residual and the shapes of laws on joints
/// whose measurement has not changed.
pub(super) struct Known<'a, 'b> {
    pub(super) recorded: Recorded<'b>,
    /// The scores that chance reaches, ascending.
    pub(super) chance: &'a [f64],
    /// Share of independent rows of each joint.
    pub(super) shares: &'a [f64],
    /// Joints whose measurement has changed.
    pub(super) changed: &'a [usize],
}

/// Lags over which a residual's memory is followed, in rows.
const LONGEST_MEMORY: usize = 400;

impl Known<'_, '_> {
    /// Share of independent rows of a joint's residual over what is not for validation.
    fn share(&self, joint: usize, switches: &[Switch], coefficients: &[f64]) -> f64 {
        let Recorded { rows, partition, layout, .. } = &self.recorded;
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
}

impl Ground for Known<'_, '_> {
    fn problem(&self) -> &Problem {
        self.recorded.problem()
    }

    fn independent_shares(&self, switches: &[Switch], coefficients: &[f64]) -> Vec<f64> {
        let mut shares = self.shares.to_vec();
        for joint in self.changed {
            shares[*joint] = self.share(*joint, switches, coefficients);
        }
        shares
    }

    fn scores_by_chance(&self, _: &[Group], _: &[Switch], _: &[f64], _: &SelectionOptions) -> Vec<f64> {
        self.chance.to_vec()
    }

    fn estimate(&mut self, group: &Group, beside: &Beside<'_>) -> bool {
        group.joints.iter().any(|j| self.changed.contains(j))
            && self.recorded.estimate(group, &Beside { deviations: false, ..*beside })
    }
}
