//! Friction models that others have registered, as candidates beside the effects of the vocabulary.
//!
//! A Coulomb, hysteresis or viscous model of a linked crate or of a dynamic library describes friction that the
//! vocabulary may have no word for. Each is tried as the joint's friction: in a further stack of equation (6) beside
//! the joint's own, with the joint's own models in the other slots, on one joint at a time. What the joint's own model
//! has too much of beside it, its refitted coefficients give back. Models that come with AURT are spoken for by
//! [`crate::effects`].
//!
//! - `proposals`: which models in which configurations;
//! - `choose`: when one is taken, and that the vocabulary comes first;
//! - `findings`: what the verdict says of those that were taken.

mod shapes;
mod trial;

use std::collections::BTreeMap;

use aurt_plugins::{ModelListing, Node, Origin, Registry};
use aurt_traits::{
    ArmTerm, CoulombModel, HysteresisModel, JointModel, JointStack, ShapeParameter, Slot, ViscousBasis,
};
use serde::Serialize;
use serde_json::{Value, json};

use crate::request::Question;
use crate::vocabulary::{Effect, Proposal};

/// What stands in the place of an effect: friction that the vocabulary may have no word for.
pub(crate) static REGISTERED: Effect = Effect { id: "registered_model", ..Effect::FRICTION };

/// A registered model that is tried.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RegisteredModel {
    pub slot: Slot,
    /// Its name in experiments.
    pub name: String,
    /// Who registered it.
    pub origin: Origin,
}

/// A registered model in one configuration on one joint.
#[derive(Debug)]
pub(crate) struct Proposed {
    pub model: RegisteredModel,
    pub proposal: Proposal,
    pub term: Box<dyn ArmTerm>,
}

/// Every registered model that is not AURT's own on every joint that does not have it, in several configurations where
/// it has shape parameters; and why models could not be tried.
pub(crate) fn proposals(question: &Question<'_>, registry: &Registry) -> (Vec<Proposed>, Vec<String>) {
    let (mut proposed, mut notes) = (Vec::new(), Vec::new());
    let asked = registry.models().filter(|_| question.considers(&REGISTERED)).filter(|listing| {
        listing.slot != Slot::ArmTerm
            && !listing.origin.is_builtin()
            && !question.without.contains(&listing.name)
    });
    for listing in asked {
        match of_model(question, registry, listing) {
            Ok(of_model) => proposed.extend(of_model),
            Err(reason) => notes.push(format!(
                "the registered {} model `{}` could not be tried: {reason}",
                listing.slot.name(),
                listing.name
            )),
        }
    }
    (proposed, notes)
}

fn of_model(
    question: &Question<'_>,
    registry: &Registry,
    listing: &ModelListing,
) -> Result<Vec<Proposed>, String> {
    let in_words = |errors: Vec<aurt_plugins::BuildError>| {
        errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
    };
    let configurations = configurations(registry, listing).map_err(in_words)?;
    let joints = question.model.joints();
    let mut proposed = Vec::new();
    for (joint, stack) in
        question.model.stacks().iter().enumerate().filter(|(j, _)| !has(question, listing, *j))
    {
        for (configuration, shapes) in &configurations {
            let term = as_friction(joint, listing.slot, configuration, stack).map_err(|e| e.to_string())?;
            let built = registry.build_from_json::<dyn ArmTerm>(&term).map_err(in_words)?;
            built.validate(joints).map_err(|complaints| {
                complaints.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
            })?;
            let columns = built.columns(joints).len();
            if columns == 0 {
                continue;
            }
            proposed.push(Proposed {
                model: RegisteredModel {
                    slot: listing.slot,
                    name: listing.name.clone(),
                    origin: listing.origin.clone(),
                },
                // A law of one column takes energy only with a positive coefficient; of several, only the sum has to.
                proposal: Proposal {
                    nonnegative: vec![columns == 1; columns],
                    fixed: shapes.clone(),
                    ..Proposal::term(vec![joint], term)
                },
                term: built,
            });
        }
    }
    trial::evaluates(question, &proposed)?;
    Ok(proposed)
}

/// A model's configurations with the shape parameters of each, the example's own first.
type Configurations = Vec<(Value, BTreeMap<String, f64>)>;

fn configurations(
    registry: &Registry,
    listing: &ModelListing,
) -> Result<Configurations, Vec<aurt_plugins::BuildError>> {
    let example = listing.example_table().map_err(|e| vec![e])?;
    match listing.slot {
        Slot::Coulomb => registry.build::<dyn CoulombModel>(&example).map(|m| varied(&example, m)),
        Slot::Hysteresis => registry.build::<dyn HysteresisModel>(&example).map(|m| varied(&example, m)),
        Slot::Viscous => registry.build::<dyn ViscousBasis>(&example).map(|m| varied(&example, m)),
        Slot::ArmTerm => Ok(Vec::new()),
    }
}

/// The example and its variants with other shape parameters, as far as the model accepts them.
fn varied<M: JointModel + Serialize + ?Sized>(example: &Node, model: Box<M>) -> Configurations
where
    Box<M>: Clone,
{
    let parameters: Vec<ShapeParameter> = model.shape_parameters();
    if parameters.is_empty() {
        return vec![(example.to_json(), BTreeMap::new())];
    }
    shapes::variants(&parameters)
        .into_iter()
        .filter_map(|values| {
            let mut variant = model.clone();
            variant.set_shape(&values).ok()?;
            let named = parameters.iter().map(|p| p.name.clone()).zip(values).collect();
            Some((without_library(serde_json::to_value(&*variant).ok()?), named))
        })
        .collect()
}

/// A model's table as an experiment writes it; what a saved model says of its library is left out.
fn without_library(mut saved: Value) -> Value {
    if let Some(keys) = saved.as_object_mut() {
        keys.remove("plugin");
    }
    saved
}

/// The joint's friction with a model in the place of the one that its stack has in that slot.
fn as_friction(
    joint: usize,
    slot: Slot,
    model: &Value,
    stack: &JointStack,
) -> Result<Value, serde_json::Error> {
    let own_coulomb = if stack.coulomb().columns().is_empty() {
        json!({ "model": "constant" })
    } else {
        without_library(serde_json::to_value(stack.coulomb())?)
    };
    let (coulomb, hysteresis) = match slot {
        Slot::Coulomb => (model.clone(), without_library(serde_json::to_value(stack.hysteresis())?)),
        Slot::Hysteresis => (own_coulomb, model.clone()),
        _ => (json!({ "model": "absent" }), json!({ "model": "sign" })),
    };
    let viscous = match slot {
        Slot::Viscous => model.clone(),
        _ => json!({ "model": "polynomial", "powers": [] }),
    };
    Ok(json!({
        "model": "joint_friction", "joints": [joint], "coulomb": coulomb, "hysteresis": hysteresis,
        "viscous": viscous,
    }))
}

/// Whether a joint has the model already, in its own friction or in a further stack.
fn has(question: &Question<'_>, listing: &ModelListing, joint: usize) -> bool {
    let model = question.model;
    let own = model.stacks().get(joint).is_some_and(|stack| {
        let name = match listing.slot {
            Slot::Coulomb => stack.coulomb().name(),
            Slot::Hysteresis => stack.hysteresis().name(),
            _ => stack.viscous().name(),
        };
        name == listing.name
    });
    let further = |term: &dyn ArmTerm| {
        serde_json::to_value(term).is_ok_and(|saved| saved[listing.slot.name()]["model"] == *listing.name)
    };
    own || model
        .arm_terms()
        .iter()
        .any(|term| term.joints(model.joints()).contains(&joint) && further(&**term))
}
