//! Destination of a planned motion: one file, or the folder of a LeRobot data set.

use std::path::{Path, PathBuf};

use aurt_recording::PlannedMotion;
use aurt_simulation::Trajectory;

use crate::workbench::failure::Failure;
use crate::workbench::output::{OutputFile, OutputFolder};

/// Folders of a data set with the files that LeRobot reads.
const FOLDERS: [&str; 3] = ["data", "meta", "videos"];
/// Folders within these that are looked into, one in another.
const DEEPEST: usize = 3;

#[derive(Debug, Clone)]
pub enum PlannedOutput {
    /// A file, whose ending tells the format.
    File(OutputFile),
    DataSet(OutputFolder),
}

impl PlannedOutput {
    /// Checks that `path` can become a file, or a folder if it ends in `.lerobot`, and is none of `inputs`. A path without an
    /// ending, such as that of a device, is a table.
    pub fn new(option: &'static str, path: &Path, inputs: &[&Path]) -> Result<Self, Failure> {
        let ending = path.extension().map(|ending| ending.to_string_lossy());
        match ending.as_deref() {
            Some("lerobot") => {}
            None | Some("csv" | "yaml" | "yml" | "script" | "mcap") => {
                return Ok(Self::File(OutputFile::new(option, path, inputs)?));
            }
            Some(_) => {
                return Err(Failure::output(
                    option,
                    path,
                    "has none of the known endings",
                    "name it .csv, .yaml, .script, .mcap or .lerobot",
                ));
            }
        }
        let folder = OutputFolder::new(option, path)?;
        let other = FOLDERS.iter().find_map(|name| other_file(&path.join(name), path, DEEPEST));
        other.map_or(Ok(Self::DataSet(folder)), |file| {
            Err(Failure::output(
                option,
                path,
                format!("has {}, which no planned motion has", file.display()),
                "name a new folder",
            ))
        })
    }

    pub fn path(&self) -> &Path {
        match self {
            Self::File(file) => file.path(),
            Self::DataSet(folder) => folder.path(),
        }
    }

    /// A rate that the format has, near one that need not be kept: LeRobot counts whole frames per second.
    pub fn near_rate_hz(&self, rate_hz: f64) -> f64 {
        match self {
            Self::File(_) => rate_hz,
            Self::DataSet(_) => rate_hz.round().max(1.0),
        }
    }

    /// Refuses a rate that the format does not have.
    pub fn check_rate_hz(&self, rate_hz: f64) -> Result<(), Failure> {
        if matches!(self, Self::DataSet(_)) && rate_hz.fract() != 0.0 {
            return Err(Failure::argument(
                "--rate-hz",
                format!("LeRobot counts whole frames per second, not {rate_hz}"),
                "give a whole number",
            ));
        }
        Ok(())
    }

    /// Writes a motion with `rate_hz` rows per second.
    pub fn write(
        &self,
        trajectory: &Trajectory,
        rate_hz: f64,
        joint_names: &[String],
    ) -> Result<(), Failure> {
        match self {
            Self::File(file) => file.write(&trajectory.formatted(file.path(), rate_hz, joint_names)?),
            Self::DataSet(folder) => {
                self.check_rate_hz(rate_hz)?;
                let motion = trajectory.planned(rate_hz, joint_names)?;
                // A motion has a rate of 1e5 at most.
                folder.write(&motion.to_lerobot(folder.path(), rate_hz as u32)?)
            }
        }
    }
}

/// A file below a folder that no planned motion has, by its name in the data set.
fn other_file(folder: &Path, data_set: &Path, deepest: usize) -> Option<PathBuf> {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() && deepest > 0 {
            if let Some(found) = other_file(&path, data_set, deepest - 1) {
                return Some(found);
            }
            continue;
        }
        let name = path.strip_prefix(data_set).unwrap_or(&path);
        if !PlannedMotion::LEROBOT_FILES.iter().any(|own| name == Path::new(own)) {
            return Some(name.to_owned());
        }
    }
    None
}
