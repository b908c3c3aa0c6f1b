use std::any::Any;

use aurt_rbd::{Joint, LinkFrame, Parent, RbdError, SerialChain, inconsistencies};
use aurt_traits::{ColumnGroup, LoadTorque, MeasurementUnit, RobotModel};
use serde_json::Value as Json;

use crate::ExportError;
use crate::naming::for_comment;

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
    pub fn lines(&self) -> Vec<String> {
        let by = self.aurt_version.as_ref().map_or_else(String::new, |v| format!(", aurt {v}"));
        let mut lines = vec![
            format!("Model: {} (schema {}{by})", self.file, self.schema),
            format!("{HASH}{}", self.blake3),
        ];
        if !self.recordings.is_empty() {
            lines.push(format!("Calibrated on: {}", self.recordings.join(", ")));
        }
        lines
    }
}

/// Whether a text states that it is an export.
pub fn is_export(text: &str) -> bool {
    text.contains(WRITTEN_BY) || text.contains(HASH)
}

/// Words that begin the statement which target wrote a file.
const WRITTEN_BY: &str = "written by `aurt export ";
const HASH: &str = "BLAKE3 of the model: ";

impl<'a> Source<'a> {
    /// The chain or tree of a model that can be exported at all.
    pub(crate) fn chain(&self) -> Result<&'a SerialChain, ExportError> {
        if self.unit == MeasurementUnit::Ampere {
            return Err(ExportError::Amperes);
        }
        self.chain_in_any_unit()
    }

    /// The same for targets that take currents too.
    pub(crate) fn chain_in_any_unit(&self) -> Result<&'a SerialChain, ExportError> {
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

    /// Which coefficients are values of which of the 10 N standard parameters: each base parameter stands at its first
    /// standard parameter, all others being zero, and the columns of the arm term `payload` at those of its link.
    pub(crate) fn places(&self) -> Result<Vec<(usize, usize)>, ExportError> {
        let mut places: Vec<(usize, usize)> = self.model.base().columns.iter().copied().enumerate().collect();
        for (k, term) in self.model.arm_terms().iter().enumerate().filter(|(_, t)| t.name() == "payload") {
            let description = serde_json::to_value(term)
                .map_err(|source| ExportError::Description { place: "arm term".into(), source })?;
            let last = self.model.joints().saturating_sub(1);
            let link = description.get("link").and_then(Json::as_u64).map_or(last, |link| link as usize);
            let listed: Option<Vec<&str>> = description
                .get("parameters")
                .and_then(Json::as_array)
                .map(|list| list.iter().filter_map(Json::as_str).collect());
            let symbols = listed.unwrap_or_else(|| STANDARD.to_vec());
            for (coefficient, symbol) in self.model.group(ColumnGroup::ArmTerm(k)).zip(symbols) {
                let index = STANDARD.iter().position(|s| *s == symbol).unwrap_or_default();
                places.push((coefficient, STANDARD.len() * link + index));
            }
        }
        Ok(places)
    }

    /// Standard parameters of bodies whose coefficients have the values that `weight` names.
    pub(crate) fn bodies(&self, weight: impl Fn(usize) -> f64) -> Result<Vec<f64>, ExportError> {
        let mut standard = vec![0.0; self.model.rigid_body().standard_parameters().len()];
        for (coefficient, place) in self.places()? {
            standard[place] += weight(coefficient);
        }
        Ok(standard)
    }
}

/// The comment with which a file of a description begins: `first`, where the model comes from, what was changed in a file of
/// the user, what the format cannot express.
pub(crate) fn heading(
    source: &Source<'_>,
    first: String,
    changed: &[String],
    program: &str,
    lost: &[String],
) -> String {
    let mut lines = vec![first];
    lines.extend(source.provenance.lines());
    for (title, said) in [("Changed:".to_owned(), changed), (format!("{program} cannot express:"), lost)] {
        if !said.is_empty() {
            lines.push(title);
            lines.extend(said.iter().map(|line| format!("  {line}")));
        }
    }
    let lines: String = lines.iter().map(|line| format!("  {}\n", for_comment(line))).collect();
    format!("<!--\n{lines}-->\n")
}

/// The standard parameters of a link, in their order.
const STANDARD: [&str; 10] = ["XX", "XY", "XZ", "YY", "YZ", "ZZ", "mX", "mY", "mZ", "m"];

/// Each link frame of a chain or tree in its parent's at coordinate zero.
pub(crate) fn frames(chain: &SerialChain) -> Result<Vec<LinkFrame>, RbdError> {
    let mut frames = Vec::new();
    let mut alone = Vec::new();
    for joint in chain.joints() {
        SerialChain::new(vec![Joint { parent: Parent::Base, ..*joint }], [0.0; 3])?
            .link_frames(&[0.0], &mut alone);
        frames.append(&mut alone);
    }
    Ok(frames)
}

impl Source<'_> {
    /// The standard parameters of a machine that can exist.
    pub(crate) fn possible_bodies(&self) -> Result<&[f64], ExportError> {
        let standard = self.standard.ok_or(ExportError::NoBodies)?;
        let expected = self.model.rigid_body().standard_parameters().len();
        if standard.len() != expected {
            let found = standard.len();
            return Err(ExportError::Count { what: "standard parameters", expected, found });
        }
        let complaints: Vec<String> = inconsistencies(standard).iter().map(ToString::to_string).collect();
        if complaints.is_empty() {
            return Ok(standard);
        }
        Err(ExportError::Impossible { complaints: complaints.join("; ") })
    }

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
