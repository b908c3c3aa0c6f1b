//! `rd_calibrated.json`: a robot model with its coefficients and all that prediction needs.

use std::path::Path;

use aurt_calibration::Calibration;
use aurt_files::output::pretty;
use aurt_plugins::Registry;
use aurt_plugins::model::model_file::{read_json, robot_model_from_json, robot_model_to_json};
use aurt_traits::{LoadTorque, RobotModel};
use serde_json::{Value, json};

use crate::data::{Instrument, Preprocessing};
use crate::error::Error;
use crate::origins::Origins;

/// The version of the file that this program reads and writes.
const SCHEMA: u64 = 1;
const KIND: &str = "calibrated_robot_dynamics";

/// A robot model with its coefficients and all that prediction needs.
#[derive(Debug, Clone)]
pub struct CalibratedModel {
    /// The model.
    pub model: RobotModel,
    /// Its coefficients, and how they were found.
    pub calibration: Calibration,
    /// How recordings are preprocessed.
    pub preprocessing: Preprocessing,
    /// What is undone in their measurements.
    pub instrument: Instrument,
    /// The files that it comes from, as far as they are known.
    pub origins: Origins,
}

impl CalibratedModel {
    /// The file's contents.
    ///
    /// # Errors
    /// If a model cannot be expressed in JSON.
    pub fn to_file(&self) -> Result<Vec<u8>, Error> {
        Ok(file_contents(json!({
            "schema": SCHEMA,
            "kind": KIND,
            "model": robot_model_to_json(&self.model)?,
            "calibration": self.calibration,
            "preprocess": self.preprocessing,
            "instrument": self.instrument,
            "provenance": self.origins,
        })))
    }

    /// Reads a file.
    ///
    /// # Errors
    /// What reading the file reports, with the place of what is wrong.
    pub fn read(path: &Path, registry: &Registry) -> Result<Self, Error> {
        let (value, text) = read_json(path)?;
        Self::from_document(path, &value, &text, registry)
    }

    /// The model in what was read of a file, its value and its text; `path` is what errors call it.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn from_document(path: &Path, value: &Value, text: &str, registry: &Registry) -> Result<Self, Error> {
        let refuse = |reason: String, remedy: &str| Error::Unfit {
            path: path.to_owned(),
            reason,
            remedy: remedy.to_owned(),
        };
        let make = "use a file made by `aurt calibrate` or `aurt run`";
        match value.get("kind").and_then(Value::as_str) {
            Some(KIND) => {}
            Some(other) => {
                return Err(refuse(format!("is a file of kind `{other}`, which has no coefficients"), make));
            }
            None => return Err(refuse("is no model file: it has no `kind`".into(), make)),
        }
        if value.get("schema").and_then(Value::as_u64) != Some(SCHEMA) {
            let found =
                value.get("schema").map_or_else(|| "missing".into(), |v| format!("{v}, another version"));
            let reason = format!("`schema` is {found}; this program reads version {SCHEMA}");
            return Err(refuse(reason, "calibrate again, or use the program that made it"));
        }
        let entry = |key: &str| value.get(key).ok_or_else(|| refuse(format!("lacks the key `{key}`"), make));
        let unreadable = |key: &str, e: &serde_json::Error| refuse(format!("`{key}`: {e}"), make);
        let model = robot_model_from_json(entry("model")?, registry)
            .map_err(|e| Error::from(e.in_file(path, text, &["model"])))?;
        let calibration: Calibration = serde_json::from_value(entry("calibration")?.clone())
            .map_err(|e| unreadable("calibration", &e))?;
        let preprocessing =
            serde_json::from_value(entry("preprocess")?.clone()).map_err(|e| unreadable("preprocess", &e))?;
        let instrument =
            serde_json::from_value(entry("instrument")?.clone()).map_err(|e| unreadable("instrument", &e))?;
        // Files of earlier versions have none.
        let origins = value.get("provenance").map_or_else(
            || Ok(Origins::default()),
            |found| serde_json::from_value(found.clone()).map_err(|e| unreadable("provenance", &e)),
        )?;
        check(&model, &calibration).map_err(|reason| refuse(reason, "calibrate again"))?;
        Ok(Self { model, calibration, preprocessing, instrument, origins })
    }
}

/// Whether the coefficients are this model's; a file may have been edited, or a plugin changed.
fn check(model: &RobotModel, calibration: &Calibration) -> Result<(), String> {
    let ours = model.parameters().iter().map(|p| p.name.as_str());
    let theirs = calibration.parameters.iter().map(|p| p.name.as_str());
    if !ours.clone().eq(theirs.clone()) {
        let (count, found) = (ours.clone().count(), theirs.clone().count());
        let difference = ours.zip(theirs).find(|(a, b)| a != b).map_or_else(
            || format!("has {found} parameters, but its model has {count}"),
            |(ours, theirs)| format!("has the parameter `{theirs}` where its model has `{ours}`"),
        );
        return Err(format!("`calibration` {difference}"));
    }
    if let LoadTorque::Fitted(weights) = &calibration.load
        && weights.len() != model.parameters().len()
    {
        return Err(format!(
            "`calibration.load` has {} weights, but its model has {} parameters",
            weights.len(),
            model.parameters().len()
        ));
    }
    let (n, entries) = (model.parameters().len(), calibration.covariance.len());
    if entries != 0 && entries != n * (n + 1) / 2 {
        let expected = n * (n + 1) / 2;
        return Err(format!(
            "`calibration.covariance` has {entries} entries, but the lower triangle of {n} parameters has {expected}"
        ));
    }
    if calibration.ranges.len() != model.joints() {
        return Err(format!(
            "`calibration.ranges` has {} entries, but its model has {} joints",
            calibration.ranges.len(),
            model.joints()
        ));
    }
    Ok(())
}

/// A model file's text, with the program that wrote it.
pub fn file_contents(mut document: Value) -> Vec<u8> {
    if let Value::Object(entries) = &mut document {
        entries.insert("aurt_version".into(), json!(env!("CARGO_PKG_VERSION")));
    }
    pretty(&document).into_bytes()
}
