//! Simpler methods on the same columns and moments, to compare a diagnosis with: what they would have named.
//!
//! They know everything that the diagnosis knows of a case (candidates with their estimated shapes, blocks of time,
//! noise floor; faults, contacts and what lies above the filters, found by the same detectors; a delay, undone) except how
//! it selects, so that the difference is selection's. They cannot answer `unexplained`.

mod best_single;
mod sparse;
mod standard;

use serde::Serialize;

use crate::investigation::Investigation;
use crate::request::Question;
use crate::verdict::contacts::contact_findings;
use crate::verdict::faults::fault_findings;
use crate::verdict::findings::delay_finding;
use crate::verdict::transmission::shaking_findings;
use crate::verdict::{Answer, Finding};

/// A method of selection.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Every candidate alone; the one with the lowest cross-validated error is named, if chance does not do as well.
    BestSingle,
    /// Least absolute shrinkage: ‖y − Xβ‖²/2n + λ‖β‖₁, λ by cross-validation (Tibshirani 1996).
    Lasso,
    /// Sequentially thresholded least squares, as in SINDy (Brunton et al. 2016), threshold by cross-validation.
    Stlsq,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::BestSingle, Self::Lasso, Self::Stlsq];

    /// Its key in `comparison.json`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::BestSingle => "best_single",
            Self::Lasso => "lasso",
            Self::Stlsq => "stlsq",
        }
    }

    /// What the method says of an investigated question.
    #[must_use]
    pub fn answer(self, question: &Question<'_>, investigation: &Investigation) -> MethodVerdict {
        let found = match self {
            Self::BestSingle => best_single::select(question, investigation).into_iter().collect(),
            Self::Lasso => sparse::select(investigation, sparse::Penalty::Absolute),
            Self::Stlsq => sparse::select(investigation, sparse::Penalty::Threshold),
        };
        let physics = found.into_iter().map(|group: usize| {
            let group = &investigation.groups[group];
            let kinds: &[&'static str] =
                if group.target_only() { &["target"] } else { &["calibration", "target"] };
            MethodFinding {
                effect: group.effect.id.to_owned(),
                joints: group.joints.clone(),
                present_in: kinds.iter().map(|k| (*k).to_owned()).collect(),
            }
        });
        let first = shaking_findings(question, investigation)
            .into_iter()
            .chain(contact_findings(question, investigation))
            .chain(delay_finding(question, investigation));
        let faults = fault_findings(question, investigation);
        let of = |finding: Finding| MethodFinding {
            effect: finding.effect,
            joints: finding.joints,
            present_in: finding.present_in,
        };
        // As in a verdict, a fault that makes no difference stands behind physics that does.
        let mut effects: Vec<MethodFinding> = first.map(of).chain(physics).collect();
        let place = if investigation.faults_matter { 0 } else { effects.len() };
        effects.splice(place..place, faults.into_iter().map(of));
        let verdict = if effects.is_empty() { Answer::NoMismatch } else { Answer::Named };
        MethodVerdict { verdict, effects }
    }
}

/// What a method says, in the form of a verdict.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodVerdict {
    /// `named` or `no_mismatch`.
    pub verdict: Answer,
    /// What it names, the largest contribution first.
    pub effects: Vec<MethodFinding>,
}

/// An effect that a method names.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodFinding {
    /// Identifier.
    pub effect: String,
    /// Joints.
    pub joints: Vec<usize>,
    /// Kinds of recordings that have it.
    pub present_in: Vec<String>,
}
