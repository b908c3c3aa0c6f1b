use std::any::Any;

use aurt_rbd::SerialChain;
use aurt_traits::{ColumnGroup, LoadTorque, MeasurementUnit, RobotModel};

use crate::ExportError;

/// A calibrated model, as exports need it.
#[derive(Debug, Clone, Copy)]
pub struct Source<'a> {
    /// Name of the robot; names in the export begin with it.
    pub name: &'a str,
    /// The model.
    pub model: &'a RobotModel,
    /// Its coefficients, in the order of [`RobotModel::parameters`].
    pub coefficients: &'a [f64],
    /// How the load torque of friction is formed.
    pub load: &'a LoadTorque,
    /// The unit of predictions.
    pub unit: MeasurementUnit,
    /// 10 N standard parameters that a machine can have, if the calibration found such.
    pub standard: Option<&'a [f64]>,
    /// Where the model comes from.
    pub provenance: &'a Provenance,
}

/// Where a model comes from. Every export states it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Provenance {
    /// The model file's name.
    pub file: String,
    /// Version of the model file's format.
    pub schema: u64,
    /// Hash of the model file.
    pub blake3: String,
    /// Version of the program that calibrated the model, if the file states it.
    pub aurt_version: Option<String>,
    /// Names of the recordings of the calibration.
    pub recordings: Vec<String>,
}

/// What an export makes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Export {
    /// Names and contents of files.
    pub files: Vec<(String, String)>,
    /// What of the model the target has no word for.
    pub lost: Vec<String>,
    /// What a person should know of the files.
    pub notes: Vec<String>,
}

impl Provenance {
    /// Lines that state it.
    #[must_use]
    pub fn lines(&self) -> Vec<String> {
        let by = self.aurt_version.as_ref().map_or_else(String::new, |v| format!(", aurt {v}"));
        let mut lines = vec![
            format!("Model: {} (schema {}{by})", self.file, self.schema),
            format!("BLAKE3 of the model: {}", self.blake3),
        ];
        if !self.recordings.is_empty() {
            lines.push(format!("Calibrated on: {}", self.recordings.join(", ")));
        }
        lines
    }
}

impl<'a> Source<'a> {
    /// The chain of a model that can be exported at all.
    ///
    /// # Errors
    /// [`ExportError::Amperes`], [`ExportError::NoChain`], [`ExportError::Count`] or [`ExportError::NotFinite`].
    pub(crate) fn chain(&self) -> Result<&'a SerialChain, ExportError> {
        if self.unit == MeasurementUnit::Ampere {
            return Err(ExportError::Amperes);
        }
        let (expected, found) = (self.model.parameters().len(), self.coefficients.len());
        if found != expected {
            return Err(ExportError::Count { what: "coefficients", expected, found });
        }
        if let LoadTorque::Fitted(weights) = self.load
            && weights.len() != expected
        {
            return Err(ExportError::Count {
                what: "weights of the load torque",
                expected,
                found: weights.len(),
            });
        }
        let weights = match self.load {
            LoadTorque::Fitted(weights) => weights.as_slice(),
            LoadTorque::Literal => &[],
        };
        let parameters = self.model.parameters();
        for values in [self.coefficients, weights] {
            if let Some((p, value)) = parameters.iter().zip(values).find(|(_, v)| !v.is_finite()) {
                return Err(ExportError::NotFinite { name: p.name.clone(), value: *value });
            }
        }
        let any: &dyn Any = &**self.model.rigid_body();
        any.downcast_ref::<SerialChain>().ok_or(ExportError::NoChain)
    }

    /// Standard parameters that give the rigid-body torque of the base parameters with the values that `weight` names:
    /// each stands at its first standard parameter, all others are zero.
    pub(crate) fn bodies(&self, weight: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut standard = vec![0.0; self.model.rigid_body().standard_parameters().len()];
        for (k, column) in self.model.base().columns.iter().enumerate() {
            standard[*column] = weight(k);
        }
        standard
    }
}

impl Source<'_> {
    /// The rotors' inertias of the arm term `rotor_inertia`, joint by joint; 0 without it.
    pub(crate) fn rotor_inertia_kg_m2(&self) -> Vec<f64> {
        let mut inertia = vec![0.0; self.model.joints()];
        for (k, term) in self.model.arm_terms().iter().enumerate() {
            if term.name() == "rotor_inertia" {
                let own = &self.coefficients[self.model.group(ColumnGroup::ArmTerm(k))];
                for (joint, value) in term.joints(self.model.joints()).iter().zip(own) {
                    inertia[*joint] += value;
                }
            }
        }
        inertia
    }
}
