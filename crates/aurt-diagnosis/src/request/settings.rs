use serde::{Deserialize, Serialize};

/// What an effect must bring to be accepted.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SelectionOptions {
    /// Least score Σ_j ½ n_eff log(MSE_before / MSE_after), cross-validated.
    pub score: f64,
    /// Least share by which the effect lowers the held-out mean squared error of some joint.
    pub reduction: f64,
    /// Least share of a joint's whole log-MSE gain that is lost without the effect.
    pub share: f64,
    /// The same for a further effect of the same kind on the same joint.
    pub share_same_kind: f64,
    /// Largest number of effects.
    pub most: usize,
    /// Candidates whose score is within this factor of the best (or within 2) compete by parameter count.
    pub tie: f64,
    /// A change that is not friction must, beyond that, lower a joint's log-MSE by this share of the log of the
    /// ratio by which the calibration recordings themselves exceed the noise floor: where the structure is wrong,
    /// whatever differs between two motions looks like a change.
    pub change_share: f64,
    /// A change of a joint's friction that reaches this share of the score of another change on the same joint is
    /// taken instead of it.
    pub everyday: f64,
    /// A group of which the baseline absorbs all but this share of torque is not decidable.
    pub free_share: f64,
}

impl Default for SelectionOptions {
    fn default() -> Self {
        Self {
            score: 8.0,
            reduction: 0.05,
            share: 0.12,
            share_same_kind: 0.15,
            most: 24,
            tie: 0.03,
            change_share: 0.15,
            everyday: 0.8,
            free_share: 0.02,
        }
    }
}
