//! Whether more is left than noise beside what was found, for each of the two questions.

use crate::evidence::account::has_structure;
use crate::evidence::baseline::weighted_fit;
use crate::evidence::between::{Share, taken};
use crate::evidence::deviations::memory;
use crate::evidence::total::TotalFit;
use crate::hypotheses::group::{Group, Switch};
use crate::investigation::{Fitted, Investigation};

/// Whether a joint keeps more than its reference beside what was found.
#[derive(Debug, Clone)]
pub(crate) struct Errors {
    /// In the targets, where recordings stand beside them: the joints.
    pub(crate) change: Option<Vec<usize>>,
    /// In the recordings beside the targets, or in all there are.
    pub(crate) structure: bool,
}

impl Errors {
    /// Of an investigation. Registered models have no names and account for nothing; joints of `apart` are left out: what
    /// was found of them is no part of the model. The noise of each joint is `louder` times its floor.
    pub(crate) fn new(
        (investigation, fitted): (&Investigation, &Fitted),
        has_targets: bool,
        apart: &[usize],
        louder: &[f64],
    ) -> Self {
        let chosen = investigation.selection.chosen.iter().map(|c| &investigation.groups[c.group]);
        let named: Vec<&Group> = chosen.filter(|g| g.is_named()).collect();
        let switches = investigation.switches_of(named.iter().copied());
        let whole = weighted_fit(&investigation.problem, &switches, &investigation.floor).0;
        let own = fitted.own(&investigation.baseline.coefficients, &investigation.base_switches);
        let friction = fitted.between.unwrap_or(Share::USUAL).changes(&investigation.model, &own);
        let of = Of { investigation, apart, friction, switches };
        let noise: Vec<f64> =
            investigation.floor.iter().zip(louder).map(|(f, louder)| louder.powi(2) * f).collect();
        let has_reference = investigation.problem.has_reference();
        if !(has_targets && has_reference) {
            return Self {
                change: None,
                structure: !of.structure(&whole, usize::from(!has_reference), &noise).is_empty(),
            };
        }
        let usual: Vec<f64> =
            of.usual(&whole).into_iter().zip(&noise).map(|(u, n)| u.powi(2).max(*n)).collect();
        let structure = !of.structure(&whole, 0, &noise).is_empty();
        Self { change: Some(of.structure(&whole, 1, &usual)), structure }
    }

    /// True if the targets keep more on a joint than the model of an unchanged arm would.
    pub(crate) fn is_of_targets(&self, joint: usize) -> bool {
        self.change.as_ref().is_some_and(|joints| joints.contains(&joint))
    }
}

struct Of<'a> {
    investigation: &'a Investigation,
    apart: &'a [usize],
    /// Changes of friction and their deviations on an unchanged robot, joint by joint.
    friction: Vec<Vec<(Switch, f64)>>,
    /// Coefficients of the whole model.
    switches: Vec<Switch>,
}

impl Of<'_> {
    /// The joints that keep more than their reference over the rows of a kind.
    fn structure(&self, fit: &TotalFit, kind: usize, references: &[f64]) -> Vec<usize> {
        let asked = |j: &usize| !self.apart.contains(j) && self.rows(kind, *j) > 0.0;
        let left = |j: usize| match kind {
            0 => self.left_beside_targets(fit, j),
            _ => self.beside_usual_friction(fit, j, references[j]),
        };
        (0..references.len())
            .filter(asked)
            .filter(|j| has_structure(left(*j).powi(2), references[*j]))
            .collect()
    }

    /// The residual of the targets beside friction that differs as that of an unchanged robot does; `reference` is the variance of noise.
    fn beside_usual_friction(&self, fit: &TotalFit, joint: usize, reference: f64) -> f64 {
        let Investigation { problem, mean_independent_share, .. } = self.investigation;
        let (columns, deviations): (Vec<Switch>, Vec<f64>) = self.friction[joint].iter().copied().unzip();
        let mut alone = vec![0.0; problem.joints()];
        alone[joint] = 1.0;
        let total = problem.total();
        let mut right = problem.right(total, &columns, &alone);
        let fitted = problem.cross(total, &columns, &self.switches, &alone);
        for (products, value) in fitted.chunks_exact(columns.len().max(1)).zip(&fit.coefficients) {
            right.iter_mut().zip(products).for_each(|(r, product)| *r -= product * value);
        }
        let gram = problem.cross(total, &columns, &columns, &alone);
        let usual = taken(&gram, &right, reference * memory(*mean_independent_share), &deviations);
        ((fit.squared_errors[1][joint] - usual).max(0.0) / self.rows(1, joint).max(1.0)).sqrt()
    }

    /// What is left of the recordings beside the targets: what the targets keep bends a fit to both.
    fn left_beside_targets(&self, fit: &TotalFit, joint: usize) -> f64 {
        self.fitted_rms(fit, 0, joint).min(self.calibrated_rms(joint))
    }

    fn rows(&self, kind: usize, joint: usize) -> f64 {
        self.investigation.problem.total()[kind][joint].rows
    }

    fn fitted_rms(&self, fit: &TotalFit, kind: usize, joint: usize) -> f64 {
        (fit.squared_errors[kind][joint] / self.rows(kind, joint).max(1.0)).sqrt()
    }

    /// What the whole model leaves of an unchanged arm in the targets' motion: what it leaves of the recordings beside
    /// them, as much larger as the torque is, and no less than noise. A wrong structure errs in proportion to the torque.
    fn usual(&self, whole: &TotalFit) -> Vec<f64> {
        let total = self.investigation.problem.total();
        (0..self.investigation.problem.joints())
            .map(|j| {
                // What never moved beside the targets has nothing that it could have changed from.
                if self.rows(0, j) <= 0.0 {
                    return f64::INFINITY;
                }
                let power = |kind: usize| total[kind][j].square / total[kind][j].rows.max(1.0);
                // What a given model leaves is no measure of the torque.
                let louder = if self.investigation.baseline.frozen || power(0) <= 0.0 {
                    1.0
                } else {
                    (power(1) / power(0)).sqrt().max(1.0)
                };
                (louder * self.left_beside_targets(whole, j)).max(self.investigation.floor[j].sqrt())
            })
            .collect()
    }

    /// What the model calibrated without the targets leaves of the recordings beside them, with the degrees of freedom that
    /// the fit takes given back: a fit to both spreads a change over both. Infinite for a given model, and where there are
    /// too few independent rows to tell.
    fn calibrated_rms(&self, joint: usize) -> f64 {
        let Investigation { problem, base_switches, baseline, mean_independent_share, .. } =
            self.investigation;
        let independent = mean_independent_share * self.rows(0, joint);
        let freedoms = base_switches.len() as f64 / problem.joints() as f64;
        if baseline.frozen || self.investigation.undetermined || independent <= freedoms {
            return f64::INFINITY;
        }
        let errors = problem.squared_errors(problem.total(), base_switches, &baseline.coefficients);
        let given_back = independent / (independent - freedoms);
        (errors[0][joint] / self.rows(0, joint).max(1.0) * given_back).sqrt()
    }
}
