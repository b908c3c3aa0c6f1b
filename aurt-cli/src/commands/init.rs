//! `aurt init`: an experiment that runs, from a robot and its logs.

use std::io::BufRead;
use std::path::PathBuf;

use aurt_diagnosis::Role;
use aurt_experiment::doctor::first_experiment::{Known, draft};
use aurt_experiment::doctor::mistakes::Examination;
use aurt_experiment::workbench::failure::Failure;
use aurt_experiment::workbench::output::OutputFile;
use aurt_rbd::MdhRows;
use aurt_rbd::robots::Part;
use aurt_report::rendering::text::wrapped;
use clap::Args;
use serde_json::json;

use super::Session;
use super::compile_rbd::ROWS;
use super::data_options::ReadingOptions;
use crate::rendering::terminal::{Report, can_ask, print_error};
use crate::values::{Constants, Gravity, choice, parse_gravity, parse_torque_constants};

/// Write an experiment for a robot and its logs.
///
/// Splits the recordings into calibration and validation unless `--validation` names some, suggests f_dyn, tries
/// common mistakes against the data, and writes every guess as a comment into the file. On a terminal it asks for what is missing.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  aurt init monday.csv tuesday.csv --robot ur10e --out experiment.toml\n  \
    aurt run experiment.toml --out results"
)]
pub struct Init {
    /// The recordings
    #[arg(value_name = "RECORDING", required = true)]
    recordings: Vec<PathBuf>,
    /// Recordings in which something may have changed, for `aurt diagnose`
    #[arg(long, value_name = "RECORDING", num_args = 1..)]
    target: Vec<PathBuf>,
    /// Recordings that are held out, of the robot as it is in the targets where there are some. Without, those of the least
    /// motion are, or the ends of the targets
    #[arg(long, value_name = "RECORDING", num_args = 1..)]
    validation: Vec<PathBuf>,
    /// The robot: a name that `aurt robots` lists, a .urdf, or a table of modified Denavit–Hartenberg parameters (.csv)
    #[arg(long, value_name = "NAME|FILE")]
    robot: Option<String>,
    /// Which joint the alpha and a of a table's row lead to
    #[arg(long, value_parser = choice(ROWS))]
    mdh_rows: Option<MdhRows>,
    /// Link from which the chain of a robot description starts
    #[arg(long, value_name = "LINK")]
    base: Option<String>,
    /// Link at which it ends; without, all joints on the base are taken, as a tree
    #[arg(long, value_name = "LINK")]
    tip: Option<String>,
    /// Links at which several chains end, separated by commas: the tree of the joints up to these
    #[arg(long, value_name = "LINK,LINK,…", value_delimiter = ',', conflicts_with = "tip")]
    tips: Vec<String>,
    /// Gravitational acceleration in the base frame, m/s²
    #[arg(long, value_name = "X Y Z", value_parser = parse_gravity, allow_hyphen_values = true)]
    gravity: Option<Gravity>,
    /// Torque per current of each joint's drive in Nm/A
    #[arg(long, value_name = "K K …", value_parser = parse_torque_constants, allow_hyphen_values = true)]
    torque_constants: Option<Constants>,
    /// File for the experiment
    #[arg(long, value_name = "EXPERIMENT.toml", default_value = "experiment.toml")]
    out: PathBuf,
    #[command(flatten)]
    reading: ReadingOptions,
}

impl Init {
    pub fn run(&self, session: &mut Session<'_>) -> Result<Report, Failure> {
        if self.out.exists() {
            return Err(Failure::argument(
                "--out",
                format!("{} exists", self.out.display()),
                "name another file, or remove that one: experiments are not overwritten",
            ));
        }
        let recordings: Vec<(&PathBuf, Option<Role>)> = [
            (&self.recordings, None),
            (&self.target, Some(Role::Target)),
            (&self.validation, Some(Role::Validation)),
        ]
        .into_iter()
        .flat_map(|(files, role)| files.iter().map(move |file| (file, role)))
        .collect();
        let inputs: Vec<&std::path::Path> = recordings.iter().map(|(file, _)| file.as_path()).collect();
        let out = OutputFile::new("--out", &self.out, &inputs)?;
        let known = Known {
            robot: self.robot()?,
            mdh_rows: self.mdh_rows,
            base: self.base.clone(),
            part: match (&self.tip, &self.tips[..]) {
                (Some(tip), _) => Part::Tips(vec![tip.clone()]),
                (None, []) => Part::All,
                (None, tips) => Part::Tips(tips.to_vec()),
            },
            gravity_m_s2: self.gravity()?.map(|Gravity(g)| g),
            torque_constants_nm_per_a: self.torque_constants.as_ref().map(|Constants(k)| k.clone()),
            recordings: recordings.iter().map(|(file, role)| (self.reading.source(file), *role)).collect(),
        };
        let draft = draft(&known, &self.out, &mut session.registry)?;
        out.write(draft.text.as_bytes())?;
        let mut text = format!("written\n  {}\n", out.path().display());
        text.extend(draft.guesses.iter().map(|g| wrapped(g)));
        if let Some(examination) = &draft.examination {
            text.push_str(&examination.to_text(session.terminal.style()));
        }
        let (command, folder) =
            if self.target.is_empty() { ("run", "results") } else { ("diagnose", "diagnosis") };
        text.push_str(&format!("\nnext\n  aurt {command} {} --out {folder}\n", out.path().display()));
        let json = json!({
            "command": "init",
            "outputs": [out.path()],
            "guesses": draft.guesses,
            "setup": draft.examination.as_ref().map(Examination::to_json),
        });
        Ok(Report { text, json, findings: false })
    }

    fn robot(&self) -> Result<String, Failure> {
        let asked =
            || ask("Robot (a name of `aurt robots`, a .urdf, an MJCF .xml, or a table of MDH parameters): ");
        self.robot.clone().or_else(asked).ok_or_else(|| {
            Failure::argument(
                "--robot",
                "the robot is not given",
                "give a name that `aurt robots` lists, a .urdf, an MJCF .xml, or a table of MDH parameters",
            )
        })
    }

    fn gravity(&self) -> Result<Option<Gravity>, Failure> {
        if self.gravity.is_some() || self.robot.is_some() {
            return Ok(self.gravity);
        }
        ask("Gravity in the base frame, x y z in m/s² (return: 0 0 -9.81, checked against the recordings): ")
            .map(|text| parse_gravity(&text))
            .transpose()
            .map_err(|reason| {
                Failure::argument("--gravity", reason, "write three numbers, such as 0 0 -9.81")
            })
    }
}

/// An answer of a person, if one is there and says something.
fn ask(question: &str) -> Option<String> {
    if !can_ask() {
        return None;
    }
    print_error(question);
    let mut answer = String::new();
    std::io::stdin().lock().read_line(&mut answer).ok()?;
    Some(answer.trim().to_owned()).filter(|a| !a.is_empty())
}
