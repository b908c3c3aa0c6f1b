use std::path::Path;

use crate::{BuildError, Registry, SlotModel};
use aurt_traits::{
    ArmTerm, CoulombModel, HysteresisModel, JointStack, ModelError, RobotModel, Slot, ViscousBasis,
};
use serde::Serialize;
use serde_json::{Value, json};

use super::json::{At, read_json};
use super::{ROBOT_DYNAMICS, SCHEMA, rigid_body};
use crate::model::error::Error;
use crate::model::rigid_bodies::RigidBodyDynamics;

/// A robot model as the value of a file of kind `robot_dynamics`.
///
/// # Errors
/// [`Error::Unsaved`] if a model cannot be expressed in JSON.
pub fn robot_model_to_json(model: &RobotModel) -> Result<Value, Error> {
    let rigid_body = rigid_body::rigid_body_to_json(&RigidBodyDynamics {
        rigid_body: model.rigid_body().clone(),
        base: model.base().clone(),
    })?;
    let joint_dynamics = model
        .stacks()
        .iter()
        .enumerate()
        .map(|(joint, stack)| {
            Ok(json!({
                "joint": joint,
                "coulomb": saved(stack.coulomb().name(), stack.coulomb())?,
                "hysteresis": saved(stack.hysteresis().name(), stack.hysteresis())?,
                "viscous": saved(stack.viscous().name(), stack.viscous())?,
            }))
        })
        .collect::<Result<Vec<_>, Error>>()?;
    let arm_terms =
        model.arm_terms().iter().map(|term| saved(term.name(), &**term)).collect::<Result<Vec<_>, _>>()?;
    Ok(json!({
        "schema": SCHEMA,
        "kind": ROBOT_DYNAMICS,
        "rigid_body_dynamics": rigid_body,
        "joint_dynamics": joint_dynamics,
        "arm_terms": arm_terms,
        "parameters": model.parameters(),
    }))
}

fn saved(name: &str, model: &(impl Serialize + ?Sized)) -> Result<Value, Error> {
    serde_json::to_value(model)
        .map_err(|e| Error::Unsaved { what: format!("the model `{name}`"), reason: e.to_string() })
}

/// A robot model from the value of a file of kind `robot_dynamics`.
///
/// # Errors
/// [`Error::ModelValue`] with the place of what is wrong.
pub fn robot_model_from_json(value: &Value, registry: &Registry) -> Result<RobotModel, Error> {
    let at = At::root(value);
    at.check_kind(ROBOT_DYNAMICS)?;
    let rigid_body = rigid_body::from_json(&at.get("rigid_body_dynamics")?)?;
    let joints = rigid_body.rigid_body.joints();
    let dynamics = at.get("joint_dynamics")?;
    let items = dynamics.items()?;
    if items.len() != joints {
        let reason = format!("has {} entries, but the rigid bodies have {joints} joints", items.len());
        return Err(dynamics.error(reason, None));
    }
    let mut stacks = Vec::new();
    for (j, item) in items.iter().enumerate() {
        let joint = item.get("joint")?;
        if joint.count()? != j as u64 {
            return Err(
                joint.error(format!("is {}, but joints follow one another from 0", joint.count()?), None)
            );
        }
        let coulomb = model::<dyn CoulombModel>(registry, &item.get("coulomb")?)?;
        let hysteresis = model::<dyn HysteresisModel>(registry, &item.get("hysteresis")?)?;
        let viscous = model::<dyn ViscousBasis>(registry, &item.get("viscous")?)?;
        stacks.push(JointStack::new(coulomb, hysteresis, viscous).map_err(|e| item.error(all(&e), None))?);
    }
    let terms = at.get("arm_terms")?;
    let arm_terms = terms
        .items()?
        .iter()
        .map(|term| model::<dyn ArmTerm>(registry, term))
        .collect::<Result<Vec<_>, Error>>()?;
    let model = RobotModel::new(rigid_body.rigid_body, rigid_body.base, stacks, arm_terms)
        .map_err(|e| terms.error(all(&e), None))?;
    check_parameters(&model, &at.get("parameters")?)?;
    Ok(model)
}

/// A model of a library that has changed since the file was written may have other columns than the file means.
fn check_parameters(model: &RobotModel, saved: &At<'_>) -> Result<(), Error> {
    let names: Vec<&str> =
        saved.items()?.iter().map(|p| p.get("name")?.text()).collect::<Result<_, Error>>()?;
    let ours = model.parameters().iter().map(|p| p.name.as_str());
    if ours.clone().eq(names.iter().copied()) {
        return Ok(());
    }
    let differing = ours.zip(&names).find(|(ours, saved)| ours != *saved);
    let difference = differing.map_or_else(
        || format!("{} of them, but the models have {}", names.len(), model.parameters().len()),
        |(ours, saved)| format!("`{saved}` where the models have `{ours}`"),
    );
    let help = "a model has changed since the file was written; make the file anew".to_owned();
    Err(saved.error(format!("lists {difference}"), help))
}

fn model<M: SlotModel + ?Sized>(registry: &Registry, at: &At<'_>) -> Result<Box<M>, Error> {
    registry.build_from_json(at.value).map_err(|errors| {
        let help = errors.iter().find_map(BuildError::help);
        let reasons: Vec<String> = errors.iter().map(ToString::to_string).collect();
        at.error(format!("{}: {}", slot_in_words(M::SLOT), reasons.join("; ")), help)
    })
}

const fn slot_in_words(slot: Slot) -> &'static str {
    match slot {
        Slot::ArmTerm => "does not describe an arm term",
        Slot::Coulomb | Slot::Hysteresis | Slot::Viscous => "does not describe a model of its slot",
    }
}

fn all(errors: &[ModelError]) -> String {
    errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
}

/// Reads a file of kind `robot_dynamics`.
///
/// # Errors
/// [`Error::Read`], or [`Error::ModelFile`] with path, line and column.
pub fn read_robot_model(path: &Path, registry: &Registry) -> Result<RobotModel, Error> {
    let (value, text) = read_json(path)?;
    robot_model_from_json(&value, registry).map_err(|e| e.in_file(path, &text, &[]))
}
