//! The model that an investigation ends with, fitted.

use aurt_traits::RobotModel;

use crate::evidence::baseline::weighted_fit;
use crate::evidence::deviations::{Resampled, beside_given};
use crate::evidence::problem::Problem;
use crate::evidence::total::TotalFit;
use crate::hypotheses::candidates::Candidate;
use crate::hypotheses::group::{Group, Switch};
use crate::investigation::Investigation;
use crate::parameters::{FittedColumn, Parameters};
use crate::vocabulary::OwnFriction;

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
    /// The covariance that a given model's has beside it, column-major; it is part of the deviations.
    pub(crate) of_given: Option<Vec<f64>>,
}

impl Fitted {
    /// Fits switches to all rows that fit.
    pub(crate) fn new(investigation: &Investigation, switches: Vec<Switch>) -> Self {
        let Investigation { problem, floor, mean_independent_share, .. } = investigation;
        Self::of(problem, floor, *mean_independent_share, switches)
    }

    /// Fits switches to a problem, of whose rows a share is independent.
    pub(super) fn of(
        problem: &Problem,
        floor: &[f64],
        independent_share: f64,
        switches: Vec<Switch>,
    ) -> Self {
        let (fit, weights) = weighted_fit(problem, &switches, floor);
        let resampled = Resampled::new(problem, &switches, &weights);
        let mut deviations = resampled.deviations(&fit, independent_share);
        let of_given = beside_given(problem, &switches, &weights);
        for (k, deviation) in deviations.iter_mut().enumerate() {
            let variance = of_given.as_ref().map_or(0.0, |c| c[k * (switches.len() + 1)].max(0.0));
            *deviation = deviation.hypot(variance.sqrt());
        }
        Self { switches, fit, weights, deviations, resampled, of_given }
    }

    /// The coefficients of the model's own columns: those of a baseline, and the fitted ones where these were fitted.
    pub(crate) fn own(&self, baseline: &[f64], base: &[Switch]) -> Vec<f64> {
        let mut own = baseline.to_vec();
        for (switch, value) in base.iter().zip(&self.fit.coefficients) {
            own[switch.column] = *value;
        }
        own
    }

    /// The parameters of a hypothesis, beside the friction that the model's `own` coefficients have.
    pub(super) fn parameters(
        &self,
        group: &Group,
        candidate: &Candidate,
        model: &RobotModel,
        own: &[f64],
    ) -> Parameters {
        let friction = OwnFriction::of(model, candidate.proposal.joints[0], own);
        let columns = self.columns(candidate, group.target_only());
        group.effect.estimated(&candidate.proposal, &columns, &friction)
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
