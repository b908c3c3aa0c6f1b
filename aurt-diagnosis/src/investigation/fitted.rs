//! The model that an investigation ends with, fitted.

use aurt_traits::RobotModel;

use crate::effects::friction_level_changed;
use crate::evidence::baseline::weighted_fit;
use crate::evidence::between::{Between, DRY, Inflation, Share};
use crate::evidence::deviations::{Resampled, beside_given, memory};
use crate::evidence::gram::dot;
use crate::evidence::linear::Cholesky;
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
    /// Standard deviations, memory and misfit of the residual included, and what calibration recordings differ by.
    pub(crate) deviations: Vec<f64>,
    /// The same model fitted without one block of time after the other.
    pub(crate) resampled: Resampled,
    /// The covariance that a given model's has beside it, column-major; it is part of the deviations.
    pub(crate) of_given: Option<Vec<f64>>,
    independent_share: f64,
    /// By how much calibration recordings differ among themselves in the coefficients of changes.
    inflations: Vec<(Vec<Switch>, Inflation)>,
    /// By how much friction differs among them, if they tell.
    pub(crate) between: Option<Share>,
}

impl Fitted {
    /// Fits switches to all rows that fit.
    pub(crate) fn new(investigation: &Investigation, switches: Vec<Switch>) -> Self {
        let Investigation { problem, floor, mean_independent_share, rows, layout, groups, .. } =
            investigation;
        let mut fitted = Self::of(problem, floor, *mean_independent_share, switches);
        let (switches, weights) = (&fitted.switches, &fitted.weights);
        let between = || Between::new(rows, layout, switches, weights, *mean_independent_share);
        let is_change = switches.iter().any(|s| s.target_only);
        let Some(between) = is_change.then(between).flatten() else { return fitted };
        let is_fitted = |g: &&Group| g.target_only() && g.switches.iter().all(|s| switches.contains(s));
        let of = |group: &Group| Some((group.switches.clone(), between.inflation(group, groups)?));
        fitted.inflations = groups.iter().filter(is_fitted).filter_map(of).collect();
        let own = fitted.own(&investigation.baseline.coefficients, &investigation.base_switches);
        let levels = groups.iter().filter(|g| g.effect == &friction_level_changed::EFFECT && g.target_only());
        let friction = |group: &Group| {
            let of = OwnFriction::of(&investigation.model, group.joints[0], &own);
            vec![DRY * of.coulomb_nm, of.viscous_nm_s]
        };
        fitted.between = between.friction_share(levels.map(|g| (g, friction(g))));
        for (own, inflation) in &fitted.inflations {
            for (k, _) in fitted.switches.iter().enumerate().filter(|(_, s)| own.contains(s)) {
                let inflated = fitted.deviation_of(k, inflation.factor);
                fitted.deviations[k] = fitted.deviations[k].max(inflated);
            }
        }
        fitted
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
        let of_given = beside_given(problem, &switches, &weights);
        let mut fitted = Self {
            switches,
            fit,
            weights,
            deviations: Vec::new(),
            resampled,
            of_given,
            independent_share,
            inflations: Vec::new(),
            between: None,
        };
        fitted.deviations = (0..fitted.switches.len()).map(|k| fitted.deviation_of(k, 1.0)).collect();
        fitted
    }

    /// Standard deviation of a coefficient: the larger of what residuals with a memory give, times a factor, and of the jackknife, which
    /// sees that a wrong model errs differently at other times.
    fn deviation_of(&self, k: usize, factor: f64) -> f64 {
        let of_memory = (self.fit.variance[k] * memory(self.independent_share)).sqrt();
        let n = self.switches.len();
        let of_given = self.of_given.as_ref().map_or(0.0, |c| c[k * (n + 1)].max(0.0));
        (factor * of_memory).max(self.resampled.std(|c| c[k])).hypot(of_given.sqrt())
    }

    /// By how much calibration recordings differ among themselves in a hypothesis of a change, if it is fitted and they tell.
    pub(super) fn inflation(&self, group: &Group) -> Option<Inflation> {
        self.inflations.iter().find(|(own, _)| *own == group.switches).map(|(_, inflation)| *inflation)
    }

    /// Standard deviation of a linear function gᵀβ of the coefficients, as that of each.
    pub(super) fn deviation(&self, problem: &Problem, g: &[f64], factor: f64) -> f64 {
        let (switches, n) = (&self.switches[..], self.switches.len());
        let mut forward = g.to_vec();
        Cholesky::new(&problem.cross(problem.total(), switches, switches, &self.weights), n)
            .forward(&mut forward);
        let of_memory = (dot(&forward, &forward) * memory(self.independent_share)).sqrt();
        let of_given = self.of_given.as_ref().map_or(0.0, |covariance| {
            let columns = covariance.chunks_exact(n).zip(g);
            columns.map(|(column, of)| of * dot(column, g)).sum::<f64>().max(0.0)
        });
        (factor * of_memory).max(self.resampled.std(|c| dot(g, c))).hypot(of_given.sqrt())
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
