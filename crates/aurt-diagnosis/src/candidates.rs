//! What effects propose, as columns of one model and as hypotheses over them.

use std::sync::Arc;

use aurt_plugins::Registry;
use aurt_traits::{ArmTerm, ColumnGroup, RobotModel};
use serde_json::Value;

use crate::{
    DiagnosisError, Instrument, Layout, Question,
    baseline::Baseline,
    effects::{self, Addition, Context, Effect, Presence, Proposal},
    problem::{Problem, Switch},
    registered::{Proposed, REGISTERED, RegisteredModel},
    selection::Group,
};

/// A proposal of an effect, with its place among the columns.
#[derive(Debug, Clone)]
pub struct Candidate {
    /// Identifier of the effect; `registered_model` for one that is of none.
    pub effect: &'static str,
    /// The registered model that it is, if it is of no effect.
    pub registered: Option<RegisteredModel>,
    /// What it proposes.
    pub proposal: Proposal,
    /// Its columns.
    pub columns: Vec<usize>,
    /// Names of its coefficients, without the joint.
    pub names: Vec<String>,
}

/// The baseline's load torque over the columns of the extended model: those of the own model come first.
pub(crate) fn extended_load(
    baseline: &Baseline,
    own: &RobotModel,
    extended: &RobotModel,
) -> aurt_traits::LoadTorque {
    match &baseline.load {
        aurt_traits::LoadTorque::Literal => aurt_traits::LoadTorque::Literal,
        aurt_traits::LoadTorque::Fitted(weights) => {
            let mut weights = weights[..own.parameters().len()].to_vec();
            weights.resize(extended.parameters().len(), 0.0);
            aurt_traits::LoadTorque::Fitted(weights)
        }
    }
}

/// Asks every effect for proposals and adds their terms to the model; registered models come last.
pub(crate) fn candidates(
    question: &Question<'_>,
    registry: &Registry,
    context: &Context<'_>,
    friction_may_be_late: bool,
    unasked: impl Fn(&str) -> bool,
    registered: Vec<Proposed>,
) -> Result<(RobotModel, Vec<Candidate>), DiagnosisError> {
    let own = question.model;
    let mut terms: Vec<Box<dyn ArmTerm>> = own.arm_terms().to_vec();
    let mut proposed: Vec<(&'static str, Option<RegisteredModel>, Proposal, Option<usize>)> = Vec::new();
    for effect in effects::all().into_iter().filter(|e| !unasked(e.id())) {
        for proposal in effect.proposals(context) {
            if !friction_may_be_late
                && matches!(proposal.addition, Addition::Instrument(_, Instrument::DelayOfAll))
            {
                continue;
            }
            let term = match &proposal.addition {
                Addition::Term(configuration) => {
                    let term = build_term(registry, effect, configuration)?;
                    terms.push(term);
                    Some(terms.len() - 1)
                }
                Addition::Instrument(..) => None,
            };
            proposed.push((effect.id(), None, proposal, term));
        }
    }
    for Proposed { model, proposal, term } in registered {
        terms.push(term);
        proposed.push((REGISTERED, Some(model), proposal, Some(terms.len() - 1)));
    }
    let model =
        RobotModel::new(Arc::clone(own.rigid_body()), own.base().clone(), own.stacks().to_vec(), terms)
            .map_err(|errors| DiagnosisError::Candidate {
                effect: "candidates",
                reason: errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "),
            })?;
    let layout = Layout::new(&model);
    let candidates = proposed
        .into_iter()
        .map(|(effect, registered, proposal, term)| {
            let (columns, names) = match (&proposal.addition, term) {
                (Addition::Instrument(joint, which), _) => {
                    (vec![layout.instrument(*joint, *which)], vec![String::new()])
                }
                (Addition::Term(_), Some(k)) => {
                    let columns: Vec<usize> = model.group(ColumnGroup::ArmTerm(k)).collect();
                    let names =
                        model.arm_terms()[k].columns(model.joints()).into_iter().map(|p| p.name).collect();
                    (columns, names)
                }
                (Addition::Term(_), None) => (Vec::new(), Vec::new()),
            };
            Candidate { effect, registered, proposal, columns, names }
        })
        .collect();
    Ok((model, candidates))
}

fn build_term(
    registry: &Registry,
    effect: &dyn Effect,
    configuration: &Value,
) -> Result<Box<dyn ArmTerm>, DiagnosisError> {
    registry.build_from_json::<dyn ArmTerm>(configuration).map_err(|errors| DiagnosisError::Candidate {
        effect: effect.id(),
        reason: errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "),
    })
}

/// Below this share of its torque a column counts as absorbed by the baseline and is left out of its group.
const ABSORBED: f64 = 1e-3;

/// Hypotheses from candidates: each in all recordings and in targets alone, without what the baseline absorbs.
pub(crate) fn groups(
    candidates: &[Candidate],
    problem: &Problem,
    base: &[Switch],
    weights: &[f64],
    question: &Question<'_>,
) -> (Vec<Group>, Vec<[f64; 2]>) {
    let mut groups = Vec::new();
    let mut free = vec![[0.0; 2]; candidates.len()];
    let target = problem.has_target();
    let reference = problem.has_reference();
    for (index, candidate) in candidates.iter().enumerate() {
        for target_only in [false, true] {
            let wanted =
                if target_only { target } else { reference && candidate.proposal.presence == Presence::Any };
            if !wanted {
                continue;
            }
            let switches: Vec<Switch> = candidate
                .columns
                .iter()
                .enumerate()
                .map(|(k, column)| Switch {
                    column: *column,
                    target_only,
                    nonnegative: candidate.proposal.nonnegative.get(k).copied().unwrap_or(false),
                })
                .collect();
            let share = problem.free_share(base, &switches, weights);
            free[index][usize::from(target_only)] = share.iter().copied().fold(0.0, f64::max);
            if free[index][usize::from(target_only)] < question.selection.free_share {
                continue;
            }
            let named_for = |k: usize| effects::find(candidate.effect).is_none_or(|e| e.is_essential(k));
            let free_ones = switches.into_iter().zip(&share).enumerate().filter(|(_, (_, s))| **s > ABSORBED);
            let (essential, switches): (Vec<bool>, Vec<Switch>) =
                free_ones.map(|(k, (switch, _))| (named_for(k), switch)).unzip();
            groups.push(Group {
                effect: candidate.effect,
                joints: candidate.proposal.joints.clone(),
                candidate: index,
                accessory: essential.iter().zip(&switches).filter(|(e, _)| !**e).map(|(_, s)| *s).collect(),
                switches,
            });
        }
    }
    (groups, free)
}
