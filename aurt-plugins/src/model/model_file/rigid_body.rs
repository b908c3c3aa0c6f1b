use std::path::Path;
use std::sync::Arc;

use aurt_traits::RigidBodyRegressor;
use serde::Deserialize;
use serde_json::{Value, json};

use super::json::{At, read_json};
use super::{RIGID_BODY_DYNAMICS, SCHEMA, base_parameters};
use crate::model::error::Error;
use crate::model::rigid_bodies::RigidBodyDynamics;

/// Rigid bodies as the value of a file of kind `rigid_body_dynamics`.
///
/// # Errors
/// [`Error::Unsaved`] if the regressor cannot be expressed in JSON.
pub fn rigid_body_to_json(dynamics: &RigidBodyDynamics) -> Result<Value, Error> {
    let body = serde_json::to_value(&*dynamics.rigid_body)
        .map_err(|e| Error::Unsaved { what: "the rigid bodies".to_owned(), reason: e.to_string() })?;
    Ok(json!({
        "schema": SCHEMA,
        "kind": RIGID_BODY_DYNAMICS,
        "joints": dynamics.rigid_body.joints(),
        "rigid_body": body,
        "base_parameters": base_parameters::to_json(&*dynamics.rigid_body, &dynamics.base),
    }))
}

pub(super) fn from_json(at: &At<'_>) -> Result<RigidBodyDynamics, Error> {
    at.check_kind(RIGID_BODY_DYNAMICS)?;
    let body = at.get("rigid_body")?;
    // Regressors are part of the program, never of a dynamic library, so serde finds them by itself.
    let rigid_body: Arc<dyn RigidBodyRegressor> = Box::<dyn RigidBodyRegressor>::deserialize(body.value)
        .map_err(|e| body.error(format!("does not describe rigid bodies: {e}"), None))?
        .into();
    let joints = at.get("joints")?;
    if joints.count()? != rigid_body.joints() as u64 {
        let reason = format!("is {}, but `rigid_body` has {} joints", joints.count()?, rigid_body.joints());
        return Err(joints.error(reason, None));
    }
    let base = base_parameters::from_json(&*rigid_body, &at.get("base_parameters")?)?;
    Ok(RigidBodyDynamics { rigid_body, base })
}

/// Reads a file of kind `rigid_body_dynamics`.
///
/// # Errors
/// [`Error::Read`], or [`Error::ModelFile`] with path, line and column.
pub fn read_rigid_body(path: &Path) -> Result<RigidBodyDynamics, Error> {
    let (value, text) = read_json(path)?;
    from_json(&At::root(&value)).map_err(|e| e.in_file(path, &text, &[]))
}
