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
        let beside_targets = investigation.left_beside_targets(&switches, &whole);
        let of = Of { investigation, apart, friction, switches, beside_targets };
        let noise: Vec<f64> =
            investigation.floor.iter().zip(louder).map(|(f, louder)| louder.powi(2) * f).collect();
        let has_reference = investigation.problem.has_reference();
        if !(has_targets && has_reference) {
            return Self {
                change: None,
                structure: !of.structure(&whole, usize::from(!has_reference), &noise).is_empty(),
            };
        }
        let usual: Vec<f64> = investigation
            .usual_errors(&of.switches, &whole)
            .iter()
            .zip(&noise)
            .map(|(u, n)| u.max(*n))
            .collect();
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
    /// Mean squares that it leaves beside the targets.
    beside_targets: Vec<f64>,
}

impl Of<'_> {
    /// The joints that keep more than their reference over the rows of a kind.
    fn structure(&self, fit: &TotalFit, kind: usize, references: &[f64]) -> Vec<usize> {
        let asked = |j: &usize| !self.apart.contains(j) && self.rows(kind, *j) > 0.0;
        let left = |j: usize| match kind {
            0 => self.beside_targets[j].sqrt(),
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

    fn rows(&self, kind: usize, joint: usize) -> f64 {
        self.investigation.problem.total()[kind][joint].rows
    }
}
