//! `aurt gains`: torque constants from unloaded motion and a load of known mass.

use std::path::PathBuf;

use aurt_calibration::KnownLoad;
use aurt_experiment::Experiment;
use aurt_experiment::workbench::failure::Failure;
use aurt_experiment::workbench::gains::{Question, drive_gains};
use aurt_experiment::workbench::output::{OutputFolder, Outputs};
use aurt_files::output::pretty;
use clap::Args;
use serde_json::json;

use super::Session;
use super::run::written_text;
use crate::rendering::terminal::Report;
use crate::values::{Position, parse_not_negative, parse_position, parse_positive};

/// Estimate the gains of the drives: their ratios from unloaded motion, the common factor from a load of known mass.
///
/// The experiment's arm term `payload` is the load; its `recordings` carry it, the other calibration recordings do not.
/// Without --mass-kg only ratios are determined. The output states which gains the recordings determine.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  aurt gains experiment.toml --mass-kg 2.805 --out gains\n  \
    aurt gains experiment.toml --mass-kg 2.805 --expect")]
pub struct GainsCommand {
    /// Experiment file
    #[arg(value_name = "EXPERIMENT.toml")]
    experiment: PathBuf,
    /// Mass of the load
    #[arg(long, value_name = "KG", value_parser = parse_positive, allow_negative_numbers = true)]
    mass_kg: Option<f64>,
    /// Standard deviation of the mass
    #[arg(long, value_name = "KG", value_parser = parse_not_negative, allow_negative_numbers = true, default_value = "0", requires = "mass_kg")]
    mass_std_kg: f64,
    /// Centre of mass of the load in the frame of the link that carries it, if known
    #[arg(long, value_name = "X Y Z", value_parser = parse_position, allow_hyphen_values = true, requires = "mass_kg")]
    centre_of_mass_m: Option<Position>,
    /// Only report what the recordings determine and with what deviation, without estimating
    #[arg(long)]
    expect: bool,
    /// Folder for gains.json; created if it does not exist
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

impl GainsCommand {
    pub fn run(&self, session: &mut Session<'_>) -> Result<Report, Failure> {
        let Session { terminal, registry, .. } = session;
        let folder = self.out.as_ref().map(|out| OutputFolder::new("--out", out)).transpose()?;
        let experiment = Experiment::read(&self.experiment, registry)?;
        let load = self.mass_kg.map(|mass_kg| KnownLoad {
            mass_kg,
            mass_std_kg: self.mass_std_kg,
            centre_of_mass_m: self.centre_of_mass_m.map(|Position(p)| p),
        });
        let question = if self.expect { Question::Expectation } else { Question::Estimate };
        let progress = terminal.progress(experiment.recordings.calibration.len() + 1);
        let found = drive_gains(&experiment, load, question, &progress)
            .map_err(|failure| failure.of_value_in(&experiment.path))?;
        drop(progress);
        let mut document = json!(found);
        document["command"] = json!("gains");
        document["experiment"] = json!(self.experiment);
        document["is_expectation"] = json!(self.expect);
        let mut text = found.to_text();
        if let Some(folder) = folder {
            let mut outputs = Outputs::default();
            outputs.folder(&folder, [("gains.json".to_owned(), pretty(&document).into_bytes())]);
            let written = outputs.paths();
            outputs.write()?;
            text.push_str(&written_text(&written));
            document["outputs"] = json!(written);
        }
        Ok(Report { text, json: document, findings: false })
    }
}
