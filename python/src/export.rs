//! Models for other programs.

use std::path::{Path, PathBuf};

use aurt::CalibratedModel;
use aurt_experiment::workbench::exporting::{self, Format, Kind, ModelFile, Replaced, Target};
use aurt_experiment::workbench::failure::Failure;
use aurt_experiment::workbench::output::OutputFolder;
use pyo3::prelude::*;

use crate::error::refused;
use crate::settings::choice;

/// What an export wrote.
#[pyclass(frozen, get_all, module = "aurt")]
pub struct Exported {
    /// Paths of the files.
    files: Vec<PathBuf>,
    /// What a person should know of them.
    notes: Vec<String>,
    /// What was changed in the file that was corrected.
    changed: Vec<String>,
    /// What of the model the target cannot express.
    lost: Vec<String>,
}

#[pymethods]
impl Exported {
    fn __repr__(&self) -> String {
        let files: Vec<String> = self.files.iter().map(|file| file.display().to_string()).collect();
        format!("<aurt.Exported: {}; {} things not exported>", files.join(", "), self.lost.len())
    }
}

/// An export that is asked for.
pub struct Order {
    target: Target,
    name: String,
    into: Option<(PathBuf, Format)>,
    ends: [Option<String>; 2],
}

impl Order {
    /// An export as a user asks for it.
    ///
    /// # Errors
    /// What does not go together.
    pub fn new(
        target: &str,
        kind: Option<&str>,
        into: Option<PathBuf>,
        ends: [Option<String>; 2],
        name: &str,
    ) -> PyResult<Self> {
        let kinds = [("inverse", Kind::Inverse), ("forward", Kind::Forward)];
        let kind = kind.map(|kind| choice("kind", kind, &kinds)).transpose()?;
        // Isaac Lab takes drives, which no model of torques is.
        let targets = Target::NAMES.map(|(name, _, target)| (name, target));
        let targets: Vec<_> = targets.into_iter().filter(|(_, target)| *target != Target::Isaac).collect();
        let target = choice("target", target, &targets)?.of_kind(kind);
        match (target, kind) {
            (Target::Fmu(_), None) => {
                return Err(refused("the target \"fmu\" needs kind=\"inverse\" or kind=\"forward\""));
            }
            (Target::Fmu(_), Some(_)) | (_, None) => {}
            (_, Some(_)) => return Err(refused("kind is of the target \"fmu\" alone; leave it out")),
        }
        let format = target.format();
        if into.is_some() && format.is_none() {
            return Err(refused("into is of the targets \"mjcf\" and \"urdf\" alone; leave it out"));
        }
        if into.is_none() && ends.iter().any(Option::is_some) {
            return Err(refused("base and tip name bodies of the file `into`, which is missing"));
        }
        Ok(Self { target, name: name.to_owned(), into: into.zip(format), ends })
    }

    /// Exports.
    ///
    /// # Errors
    /// What the target cannot take, and where files cannot be.
    pub fn carry_out(
        &self,
        model: &CalibratedModel,
        out: &Path,
        replaced: Replaced,
    ) -> Result<Exported, Failure> {
        let out = OutputFolder::new("out", out)?;
        let model = ModelFile::of(model.clone())?;
        let made = match &self.into {
            Some((file, format)) => {
                exporting::correct(&model, file, *format, self.ends.each_ref().map(Option::as_deref))?
            }
            None => exporting::export(&model, &self.name, self.target)?,
        };
        let inputs: Vec<&Path> = self.into.iter().map(|(file, _)| file.as_path()).collect();
        let files = made.write(&out, "out", &inputs, replaced)?;
        Ok(Exported { files, notes: made.notes, changed: made.changed, lost: made.lost })
    }
}
