//! Whether more is left than noise beside what was found, for each of the two questions.

use crate::evidence::account::has_structure;
use crate::evidence::baseline::weighted_fit;
use crate::hypotheses::group::Group;
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
        let noise: Vec<f64> =
            investigation.floor.iter().zip(louder).map(|(f, louder)| louder.powi(2) * f).collect();
        let shows = |kind: usize, left: &[f64], references: &[f64]| -> Vec<usize> {
            let total = &investigation.problem.total()[kind];
            let asked = |j: &usize| !apart.contains(j) && total[*j].rows > 0.0;
            let joints = (0..references.len()).filter(asked);
            joints.filter(|j| has_structure(left[*j], references[*j])).collect()
        };
        let in_targets = |references: &[f64]| {
            shows(1, &investigation.left_in_targets(fitted, &switches, &whole, references), references)
        };
        if !investigation.problem.has_reference() {
            return Self { change: None, structure: !in_targets(&noise).is_empty() };
        }
        let beside = investigation.left_beside_targets(&switches, &whole);
        let structure = !shows(0, &beside, &noise).is_empty();
        let usual = investigation.usual_errors(&switches, &whole).into_iter().zip(&noise);
        let usual: Vec<f64> = usual.map(|(usual, noise)| usual.max(*noise)).collect();
        Self { change: has_targets.then(|| in_targets(&usual)), structure }
    }

    /// True if the targets keep more on a joint than the model of an unchanged arm would.
    pub(crate) fn is_of_targets(&self, joint: usize) -> bool {
        self.change.as_ref().is_some_and(|joints| joints.contains(&joint))
    }
}
