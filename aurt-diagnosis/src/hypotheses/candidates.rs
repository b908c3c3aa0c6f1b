//! What effects propose, as columns of one model and as hypotheses over them.

use std::sync::Arc;

use aurt_plugins::Registry;
use aurt_traits::{ArmTerm, ColumnGroup, RobotModel};
use serde_json::Value;

use crate::effects;
use crate::error::DiagnosisError;
use crate::hypotheses::registered::{Proposed, REGISTERED, RegisteredModel};
use crate::recordings::rows::Layout;
use crate::request::Question;
use crate::vocabulary::{Addition, Context, Effect, Means, Proposal};

/// A proposal of an effect, with its place among the columns.
#[derive(Debug, Clone)]
pub struct Candidate {
    /// The effect; of a registered model one that stands for all of these.
    pub effect: &'static Effect,
    /// The registered model that it is, if it is of no effect.
    pub registered: Option<RegisteredModel>,
    /// What it proposes.
    pub proposal: Proposal,
    pub columns: Vec<usize>,
    /// Names of its coefficients, without the joint.
    pub names: Vec<String>,
}

/// Asks every effect for proposals and adds their terms to the model; registered models come last. Gears of `simulated` joints, whose
/// torque is taken out already, are not proposed.
pub(crate) fn candidates(
    question: &Question<'_>,
    registry: &Registry,
    context: &Context<'_>,
    registered: Vec<Proposed>,
    simulated: &[usize],
) -> Result<(RobotModel, Vec<Candidate>), DiagnosisError> {
    let own = question.model;
    let mut terms: Vec<Box<dyn ArmTerm>> = own.arm_terms().to_vec();
    let mut proposed: Vec<(&'static Effect, Option<RegisteredModel>, Proposal, Option<usize>)> = Vec::new();
    let considered = effects::ALL.into_iter().filter(|e| question.considers(e));
    let of_effects = considered.flat_map(|e| (e.propose)(context).into_iter().map(move |p| (e, p)));
    let elsewhere = |e: &Effect, p: &Proposal| e.means != Means::Columns && simulated.contains(&p.joints[0]);
    for (effect, proposal) in of_effects.filter(|(e, p)| !elsewhere(e, p)) {
        let term = match &proposal.addition {
            Addition::Term(configuration) => {
                terms.push(build_term(registry, effect, configuration)?);
                Some(terms.len() - 1)
            }
            Addition::Instrument(..) => None,
        };
        proposed.push((effect, None, proposal, term));
    }
    for Proposed { model, proposal, term } in registered {
        terms.push(term);
        proposed.push((&REGISTERED, Some(model), proposal, Some(terms.len() - 1)));
    }
    let model = with_terms(own, terms)?;
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

/// A model with other arm terms.
pub(crate) fn with_terms(
    own: &RobotModel,
    terms: Vec<Box<dyn ArmTerm>>,
) -> Result<RobotModel, DiagnosisError> {
    RobotModel::new(Arc::clone(own.rigid_body()), own.base().clone(), own.stacks().to_vec(), terms).map_err(
        |errors| DiagnosisError::Candidate {
            effect: "candidates",
            reason: errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "),
        },
    )
}

/// The term of a proposal.
pub(crate) fn build_term(
    registry: &Registry,
    effect: &Effect,
    configuration: &Value,
) -> Result<Box<dyn ArmTerm>, DiagnosisError> {
    registry.build_from_json::<dyn ArmTerm>(configuration).map_err(|errors| DiagnosisError::Candidate {
        effect: effect.id,
        reason: errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "),
    })
}
