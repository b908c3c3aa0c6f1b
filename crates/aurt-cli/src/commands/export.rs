//! `aurt export`: calibrated models for other programs.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use serde_json::json;

use super::Session;
use crate::{
    exporting::{Target, export},
    failure::Failure,
    output::OutputFolder,
    rendering::{
        terminal::{Emphasis, Report},
        text::wrapped,
    },
};

/// Export a calibrated model to other programs: C source, MuJoCo.
///
/// `c` writes a C99 header and source (torque, friction, gravity, mass matrix) that need math.h alone, and a program that
/// compares them with the model. `mjcf` writes a MuJoCo model, of a calibration with `estimator = "consistent"`. What the
/// target has no word for is listed; what cannot be exported is refused.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  aurt export c rd_calibrated.json --name my_robot --out exported_c\n  \
    aurt export mjcf rd_calibrated.json --name my_robot --out exported_mjcf")]
pub struct Export {
    /// What the model becomes
    #[arg(value_enum)]
    target: TargetName,
    /// Calibrated robot dynamics from `aurt calibrate` or `aurt run`
    #[arg(value_name = "MODEL")]
    model: PathBuf,
    /// Name of the robot; files and functions are called after it
    #[arg(long, value_name = "NAME", default_value = "robot")]
    name: String,
    /// Folder for the files
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

/// A target of an export.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum TargetName {
    /// C99 header and source, and a program that checks them
    C,
    /// MuJoCo model
    Mjcf,
}

impl From<TargetName> for Target {
    fn from(name: TargetName) -> Self {
        match name {
            TargetName::C => Self::C,
            TargetName::Mjcf => Self::Mjcf,
        }
    }
}

impl Export {
    /// Exports.
    pub fn run(&self, session: &Session<'_>) -> Result<Report, Failure> {
        let out = OutputFolder::new("--out", &self.out)?;
        let target = Target::from(self.target);
        let made = export(&self.model, &self.name, target, &session.registry)?;
        let files: Vec<(String, Vec<u8>)> =
            made.files.iter().map(|(name, text)| (name.clone(), text.clone().into_bytes())).collect();
        let paths: Vec<PathBuf> = files.iter().map(|(name, _)| out.path().join(name)).collect();
        // An input in the folder must survive.
        if let Some(path) = paths.iter().find(|p| same_file(p, &self.model)) {
            return Err(Failure::Output {
                option: "--out",
                path: path.clone(),
                reason: "is an input of this command and would be overwritten".into(),
                remedy: "name another folder".into(),
            });
        }
        out.write(&files)?;

        let mut text = format!("{} of {}\n", target.name(), self.model.display());
        text.extend(made.notes.iter().map(|n| wrapped(&format!("note: {n}"))));
        let warning = session.terminal.emphasise(Emphasis::Warning, "not exported");
        text.extend(made.lost.iter().map(|l| wrapped(&format!("{warning}: {l}"))));
        text.extend(paths.iter().map(|p| format!("written: {}\n", p.display())));
        let json = json!({
            "command": "export",
            "target": target.name(),
            "notes": made.notes,
            "lost": made.lost,
            "outputs": paths,
        });
        Ok(Report { text, json, findings: false })
    }
}

fn same_file(a: &std::path::Path, b: &std::path::Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}
