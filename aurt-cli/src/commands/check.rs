//! `aurt check`: what a recording is good for, before anyone calibrates on it.

use std::path::PathBuf;

use aurt_experiment::Experiment;
use aurt_experiment::doctor::checkup::{Checkup, Given, Known, Question, check};
use aurt_experiment::workbench::driving::check_drives;
use aurt_experiment::workbench::failure::Failure;
use aurt_experiment::workbench::output::{OutputFolder, Outputs};
use aurt_rbd::{MdhRows, MdhTable};
use aurt_report::reports;
use clap::Args;
use serde_json::json;

use super::compile_rbd::ROWS;
use super::data_options::ReadingOptions;
use super::plots::PlotOptions;
use super::run::{drawn_text, written_text};
use super::{Session, checked_setup};
use crate::rendering::terminal::Report;
use crate::values::{Gravity, choice, parse_gravity, parse_positive};

/// Check recordings before calibrating on them.
///
/// Reports sampling, range and sensor quality of each joint and, with the robot's geometry, which
/// parameters the motions determine, for each recording and for all together. Tries common mistakes of the
/// setup (units, signs, orders, gravity, tables, delays) against the data and reports the fix
/// that explains them. Exit status 1 if there are findings.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  aurt check recording.csv\n  \
    aurt check experiment.toml --fixed corrected.toml\n  \
    aurt check recording.csv --mdh mdh.csv --gravity 0 0 -9.81 --out check\n  \
    aurt check monday.csv tuesday.csv --mdh mdh.csv")]
pub struct Check {
    /// Recordings to be calibrated on together, or one experiment (.toml)
    #[arg(value_name = "RECORDING|EXPERIMENT.toml", required = true)]
    recordings: Vec<PathBuf>,
    /// Table of modified Denavit–Hartenberg parameters; with it the check reports which parameters the
    /// motion determines
    #[arg(long, value_name = "MDH.csv")]
    mdh: Option<PathBuf>,
    /// Which joint a row's alpha and a lead to
    #[arg(long, value_parser = choice(ROWS), default_value = "next", requires = "mdh")]
    mdh_rows: MdhRows,
    /// Gravitational acceleration in the base frame, m/s²
    #[arg(
        long, value_name = "X Y Z", value_parser = parse_gravity, allow_hyphen_values = true,
        default_value = "0 0 -9.81", requires = "mdh"
    )]
    gravity: Gravity,
    /// Highest frequency of the robot's dynamics; by default 10, less for slow recordings
    #[arg(long, value_name = "HZ", value_parser = parse_positive)]
    f_dyn_hz: Option<f64>,
    /// File for the corrected experiment, in the folder of the experiment; written if mistakes were found
    #[arg(long, value_name = "OUT.toml")]
    fixed: Option<PathBuf>,
    /// Folder for report.html, one folder for each of several recordings; created if it does not exist
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    plots: PlotOptions,
    #[command(flatten)]
    reading: ReadingOptions,
}

impl Check {
    pub fn run(&self, session: &mut Session<'_>) -> Result<Report, Failure> {
        let folder = self.out.as_deref().map(|out| OutputFolder::new("--out", out)).transpose()?;
        let plots = self.plots.folder()?;
        let experiment = match self.recordings.as_slice() {
            [one] if one.extension().is_some_and(|e| e == "toml") => {
                Some(Experiment::read_with_drives(one, &mut session.registry)?)
            }
            _ => None,
        };
        if let Some(experiment) = experiment.as_ref().filter(|e| e.drive.is_some()) {
            return self.drives(experiment, session);
        }
        let fixed = checked_setup::place(self.fixed.as_deref(), experiment.as_ref())?;
        let table = self.mdh.as_ref().map(|p| MdhTable::from_path(p, self.mdh_rows)).transpose()?;
        let robot = match (&experiment, &table) {
            (Some(experiment), _) => Known::Experiment(experiment),
            (None, Some(table)) => Known::Table(table, self.gravity.0),
            (None, None) => Known::Nothing,
        };
        let files = self.recordings.iter().filter(|_| experiment.is_none());
        let checkup = check(Question {
            robot,
            recordings: files.map(|f| Given::File(Box::new(self.reading.source(f)))).collect(),
            f_dyn_hz: self.f_dyn_hz,
            registry: &session.registry,
        })?;
        let mut report = Report {
            text: checkup.to_text(session.terminal.style()),
            json: checkup.to_json(),
            findings: checkup.has_findings(),
        };
        report.json["command"] = json!("check");
        if let Some((fixed, experiment)) = fixed.as_ref().zip(experiment.as_ref()) {
            checked_setup::correct(&checkup, experiment, fixed, &mut report)?;
        }
        self.draw(&checkup, &mut report, folder.as_ref(), plots.as_ref())?;
        Ok(report)
    }

    fn drives(&self, experiment: &Experiment, session: &Session<'_>) -> Result<Report, Failure> {
        let given = [("--fixed", self.fixed.is_some()), ("--out", self.out.is_some())];
        if let Some((option, _)) = given.into_iter().find(|(_, is_given)| *is_given) {
            let reason = "is of recordings with torques, and this experiment has a [drive]";
            let remedy = format!("leave out {option}: what is found is printed, and in the output of --json");
            return Err(Failure::argument(option, reason, remedy));
        }
        let count = experiment.recordings.calibration.len() + experiment.recordings.validation.len();
        let outcome = check_drives(experiment, &session.terminal.progress(count + 2))?;
        let mut json = outcome.json;
        json["command"] = json!("check");
        Ok(Report { text: outcome.text, json, findings: outcome.findings })
    }

    /// Pages and figures; of several recordings each in a folder of its own.
    fn draw(
        &self,
        checkup: &Checkup,
        report: &mut Report,
        folder: Option<&OutputFolder>,
        plots: Option<&OutputFolder>,
    ) -> Result<(), Failure> {
        if folder.is_none() && plots.is_none() {
            return Ok(());
        }
        let (mut pages, mut figures) = (Vec::new(), Vec::new());
        let mut outputs = Outputs::default();
        let drawn = checkup.pages();
        for (name, page) in &drawn {
            let part = |of: Option<&OutputFolder>, option| -> Result<Option<OutputFolder>, Failure> {
                match of {
                    Some(whole) if drawn.len() > 1 => {
                        OutputFolder::nested(option, &whole.path().join(name)).map(Some)
                    }
                    whole => Ok(whole.cloned()),
                }
            };
            let (folder, plots) = (part(folder, "--out")?, part(plots, "--plots")?);
            if let Some(folder) = &folder {
                outputs.folder(folder, [(reports::FILE.to_owned(), page.to_html().into_bytes())]);
                pages.push(folder.path().join(reports::FILE));
            }
            figures.extend(outputs.figures(page, plots.as_ref()));
        }
        outputs.write()?;
        report.text.push_str(&written_text(&pages));
        report.text.push_str(&drawn_text(&figures, plots));
        pages.extend(figures);
        report.json["outputs"] = json!(pages);
        Ok(())
    }
}
