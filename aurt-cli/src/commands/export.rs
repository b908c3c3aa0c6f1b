//! `aurt export`: calibrated models for other programs.

use std::path::{Path, PathBuf};

use aurt_experiment::Experiment;
use aurt_experiment::workbench::driving::CalibratedDrive;
use aurt_experiment::workbench::exporting::{Format, Kind, ModelFile, Replaced, Target, correct, export};
use aurt_experiment::workbench::failure::Failure;
use aurt_experiment::workbench::output::OutputFolder;
use aurt_experiment::workbench::read_back::{DURATION_S, TorqueDifference};
use aurt_plugins::model::model_file::read_json;
use aurt_report::rendering::text::wrapped;
use clap::Args;
use serde_json::json;

use super::Session;
use crate::rendering::terminal::{Emphasis, Report};
use crate::values::{Choice, choice};

/// Export a calibrated model to other programs: C or Rust source, MuJoCo, URDF, SDF, FMI, Isaac Lab.
///
/// `c` writes a C99 header and source (torque, friction, gravity, mass matrix) that need math.h only, and a
/// program that checks them against the model; `rust` writes the same functions as a crate, `no_std` where
/// wanted. `mjcf` writes a MuJoCo model, `urdf` a URDF file and `sdf` an SDF file for Gazebo, of a calibration
/// with `estimator = "consistent"`; `--into` corrects your MuJoCo or URDF file instead. `fmu` writes a
/// functional mock-up unit for co-simulation, of inverse dynamics (a motion in, torques or currents out) or of
/// forward dynamics (torques or currents in, the motion out). What the target cannot express is listed; what
/// cannot be exported is refused.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  aurt export c rd_calibrated.json --name my_robot --out exported_c\n  \
    aurt export rust rd_calibrated.json --name my_robot --out exported_rust\n  \
    aurt export mjcf rd_calibrated.json --name my_robot --out exported_mjcf\n  \
    aurt export mjcf rd_calibrated.json --into my_robot.xml --out exported_mjcf\n  \
    aurt export urdf rd_calibrated.json --name my_robot --out exported_urdf\n  \
    aurt export urdf rd_calibrated.json --into my_robot.urdf --out exported_urdf\n  \
    aurt export sdf rd_calibrated.json --name my_robot --out exported_sdf\n  \
    aurt export fmu rd_calibrated.json --kind forward --name my_robot --out exported_fmu\n  \
    aurt export isaac drive_calibrated.json --name my_robot --experiment servo.toml --out exported_isaac")]
pub struct Export {
    /// Target of the export
    #[arg(value_parser = choice(&Target::NAMES))]
    target: Target,
    /// Calibrated robot dynamics from `aurt calibrate` or `aurt run`; for `mjcf` drives as well, with a script for what
    /// MuJoCo cannot express
    #[arg(value_name = "MODEL")]
    model: PathBuf,
    /// Name of the robot, used for files and functions
    #[arg(long, value_name = "NAME", default_value = "robot")]
    name: String,
    /// Folder for the files
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// What an FMU computes
    #[arg(long, value_parser = choice(KINDS), required_if_eq("target", "fmu"))]
    kind: Option<Kind>,
    /// Version of FMI: 2 (the one that is written)
    #[arg(long, value_parser = choice(FMI))]
    fmi: Option<u32>,
    /// Your MuJoCo or URDF file, with which the model was calibrated: written as FILE_calibrated with corrected
    /// dynamics; comments, shapes and everything else stay
    #[arg(long, value_name = "XML|URDF")]
    into: Option<PathBuf>,
    /// Body or link of that file at which the chain starts, if there is a choice
    #[arg(long, value_name = "BODY", requires = "into")]
    base: Option<String>,
    /// Body or link of that file at which the chain ends, if there is a choice
    #[arg(long, value_name = "BODY", requires = "into")]
    tip: Option<String>,
    /// For `isaac`: experiment of the drives, whose held-out recordings show what the export loses
    #[arg(long, value_name = "DRIVES.toml")]
    experiment: Option<PathBuf>,
    /// Replace files in the folder that are not by `aurt export`, and FMUs; never the model or the file of `--into`
    #[arg(long)]
    force: bool,
}

const KINDS: &[Choice<Kind>] = &[
    ("inverse", "Torques or currents of a motion", Kind::Inverse),
    ("forward", "The motion that torques or currents make", Kind::Forward),
];
const FMI: &[Choice<u32>] = &[("2", "FMI 2.0", 2)];

impl Export {
    fn target(&self) -> Result<Target, Failure> {
        if self.target != Target::Isaac && self.experiment.is_some() {
            return Err(Failure::argument(
                "--experiment",
                "is of the target `isaac` alone",
                "leave it out, or export to `isaac`",
            ));
        }
        if !matches!(self.target, Target::Fmu(_)) {
            for (option, given) in [("--kind", self.kind.is_some()), ("--fmi", self.fmi.is_some())] {
                if given {
                    return Err(Failure::argument(
                        option,
                        "is of the target `fmu` alone",
                        "leave it out, or export to `fmu`",
                    ));
                }
            }
        }
        Ok(self.target.of_kind(self.kind))
    }

    /// The user's file, if the target corrects one.
    fn original(&self) -> Result<Option<(&PathBuf, Format)>, Failure> {
        let Some(file) = &self.into else { return Ok(None) };
        let reason = "is of the targets `mjcf` and `urdf` alone";
        let refusal = || Failure::argument("--into", reason, "leave it out, or export to one of these");
        Ok(Some((file, self.target.format().ok_or_else(refusal)?)))
    }

    pub fn run(&self, session: &Session<'_>) -> Result<Report, Failure> {
        let out = OutputFolder::new("--out", &self.out)?;
        let target = self.target()?;
        // Once: it may be a pipe.
        let (document, read) = read_json(&self.model)?;
        let made = match (CalibratedDrive::from_document(&self.model, &document)?, self.original()?) {
            (Some(drive), None) if target == Target::Mjcf => drive.to_mjcf(&self.name)?,
            (Some(drive), None) if target == Target::Isaac => {
                let read = |path: &PathBuf| Experiment::read_with_drives(path, &mut session.registry.clone());
                drive.to_isaac(&self.name, self.experiment.as_ref().map(read).transpose()?.as_ref())?
            }
            (Some(_), original) => {
                let option = if original.is_some() { "--into" } else { "TARGET" };
                let reason = "a model of drives is exported as a MuJoCo model of its own or to Isaac Lab";
                let remedy = "use `aurt export mjcf` or `isaac` without `--into`";
                return Err(Failure::argument(option, reason, remedy));
            }
            (None, original) => {
                let model = ModelFile::from_document(&self.model, document, &read, &session.registry)?;
                match original {
                    Some((file, format)) => {
                        correct(&model, file, format, [self.base.as_deref(), self.tip.as_deref()])?
                    }
                    None => export(&model, &self.name, target)?,
                }
            }
        };
        let inputs: Vec<&Path> =
            [Some(&self.model), self.into.as_ref()].into_iter().flatten().map(PathBuf::as_path).collect();
        let replaced = if self.force { Replaced::Any } else { Replaced::Exports };
        let paths = made.write(&out, "--out", &inputs, replaced)?;

        let mut text = format!("{} of {}\n", target.name(), self.model.display());
        text.extend(made.notes.iter().map(|n| wrapped(&format!("note: {n}"))));
        text.extend(made.changed.iter().map(|c| wrapped(&format!("changed: {c}"))));
        let warning = session.terminal.emphasise(Emphasis::Warning, "not exported");
        text.extend(made.lost.iter().map(|l| wrapped(&format!("{warning}: {l}"))));
        text.push_str(&differences(&made.differences));
        text.extend(paths.iter().map(|p| format!("written: {}\n", p.display())));
        let json = json!({
            "command": "export",
            "target": target.name(),
            "notes": made.notes,
            "changed": made.changed,
            "lost": made.lost,
            "differences": made
                .differences
                .iter()
                .map(|d| json!({
                    "joint": d.joint,
                    "difference_nm": d.difference_nm,
                    "torque_nm": d.torque_nm,
                    "relative": d.relative(),
                }))
                .collect::<Vec<_>>(),
            "outputs": paths,
        });
        Ok(Report { text, json, findings: false })
    }
}

/// The torques of a file that was read back, joint by joint.
fn differences(differences: &[TorqueDifference]) -> String {
    if differences.is_empty() {
        return String::new();
    }
    let mut text = wrapped(&format!(
        "torques of the file, as AURT reads it, less those of the model over {DURATION_S:.0} s of sines with the speeds of the calibration, RMS:"
    ));
    let width = differences.iter().map(|difference| difference.joint.chars().count()).max().unwrap_or(0);
    for difference in differences {
        let TorqueDifference { joint, difference_nm, torque_nm } = difference;
        let percent = 100.0 * difference.relative();
        text.push_str(&format!(
            "    {joint:width$}  {difference_nm:.4} of {torque_nm:.4} Nm, {percent:.2} %\n"
        ));
    }
    text
}
