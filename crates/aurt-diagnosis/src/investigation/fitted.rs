//! The model that an investigation ends with, fitted.

use crate::evidence::baseline::weighted_fit;
use crate::evidence::deviations::Resampled;
use crate::evidence::problem::TotalFit;
use crate::hypotheses::candidates::Candidate;
use crate::hypotheses::effects::FittedColumn;
use crate::hypotheses::group::Switch;
use crate::investigation::Investigation;

/// Coefficients, their deviations, and the weights that they were fitted with.
#[derive(Debug)]
pub(crate) struct Fitted {
    /// Which coefficients.
    pub(crate) switches: Vec<Switch>,
    /// Their values.
    pub(crate) fit: TotalFit,
    /// One over the residual's variance, joint by joint.
    pub(crate) weights: Vec<f64>,
    /// Standard deviations, memory and misfit of the residual included.
    pub(crate) deviations: Vec<f64>,
    /// The same model fitted without one block of time after the other.
    pub(crate) resampled: Resampled,
}

impl Fitted {
    /// Fits switches to all rows that fit.
    pub(crate) fn new(investigation: &Investigation, switches: Vec<Switch>) -> Self {
        let problem = &investigation.problem;
        let (fit, weights) = weighted_fit(problem, &switches, &investigation.floor);
        let resampled = Resampled::new(problem, &switches, &weights);
        let deviations = resampled.deviations(&fit, investigation.mean_independent_share);
        Self { switches, fit, weights, deviations, resampled }
    }

    /// Place of a coefficient.
    pub(crate) fn place(&self, column: usize, target_only: bool) -> Option<usize> {
        self.switches.iter().position(|s| s.column == column && s.target_only == target_only)
    }

    /// (name, value, standard deviation) of a candidate's coefficients; those that the baseline absorbs are zero.
    pub(crate) fn columns(&self, candidate: &Candidate, target_only: bool) -> Vec<FittedColumn> {
        let named = candidate.columns.iter().zip(&candidate.names);
        named
            .map(|(column, name)| match self.place(*column, target_only) {
                Some(k) => (name.clone(), self.fit.coefficients[k], self.deviations[k]),
                None => (name.clone(), 0.0, f64::INFINITY),
            })
            .collect()
    }
}
