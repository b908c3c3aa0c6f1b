//! `aurt sensitivity`: from which size on an effect would have been found in these recordings.

use std::path::PathBuf;

use aurt_diagnosis::Prepared;
use aurt_experiment::Experiment;
use aurt_experiment::workbench::failure::Failure;
use aurt_experiment::workbench::output::{OutputFolder, Outputs};
use aurt_experiment::workbench::reports::sensitivity::Answered;
use aurt_experiment::workbench::sensitivity::{
    Check, DRAWS, LEVELS, NAMED_IN, Subject, Trials, check, search, tasks,
};
use aurt_files::output::pretty;
use aurt_report::reports;
use aurt_simulation::inject::{Kind, injectable};
use clap::Args;
use serde_json::json;

use super::Session;
use super::plots::PlotOptions;
use crate::rendering::terminal::Report;

/// Find the smallest size of each effect that the experiment's recordings would show: "nothing is missing"
/// becomes "nothing larger than this is missing".
///
/// Adds each effect to the measured recordings with increasing strength, in five draws of shape and noise, and diagnoses
/// the result; the limit is the strength at which four of five diagnoses name it. If the experiment has targets, the effect
/// is added to them and to the held-out data, otherwise to all recordings.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  aurt sensitivity experiment.toml --out sensitivity\n  \
    aurt sensitivity experiment.toml --effects payload,spring --joints 1,2 --out sensitivity")]
pub struct Sensitivity {
    /// Experiment file
    #[arg(value_name = "EXPERIMENT.toml")]
    experiment: PathBuf,
    /// Folder for report.html and sensitivity.json; created if it does not exist
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Effects to try, separated by commas; default: all
    #[arg(long, value_name = "EFFECTS", value_delimiter = ',')]
    effects: Vec<String>,
    /// Joints to try, counted from 0, separated by commas; default: all
    #[arg(long, value_name = "JOINTS", value_delimiter = ',')]
    joints: Vec<usize>,
    /// Seed of the shapes that are drawn
    #[arg(long, value_name = "N", default_value = "1")]
    seed: u64,
    /// Check N of the limits (default 12) with complete diagnoses, at twice and at half the size
    #[arg(long, value_name = "N", num_args = 0..=1, require_equals = true, default_missing_value = "12")]
    check: Option<usize>,
    #[command(flatten)]
    plots: PlotOptions,
}

const RESULTS: &str = "sensitivity.json";

impl Sensitivity {
    pub fn run(&self, session: &mut Session<'_>) -> Result<Report, Failure> {
        let Session { terminal, registry, .. } = session;
        let folder = OutputFolder::new("--out", &self.out)?;
        let plots = self.plots.folder()?;
        let experiment = Experiment::read(&self.experiment, registry)?;
        let joints = self.joints(experiment.joints())?;
        let subject = Subject::new(&experiment)?;
        let unit = subject.injection.real().unit;
        let names: Vec<String> = if self.effects.is_empty() {
            injectable(unit).into_iter().map(str::to_owned).collect()
        } else {
            self.effects.clone()
        };
        let effects = names.iter().map(|name| Kind::named(name)).collect::<Result<Vec<_>, _>>()?;
        let checked = self.check.unwrap_or(0);
        let progress = terminal.progress(1 + tasks(&effects, &joints) + checked);
        let question = subject.question();
        let prepared = Prepared::new(&question, registry, |_| {})?;
        progress.step("the recordings as they are");
        let trials = Trials::new(&subject, &prepared, registry);
        let done = |what: &str| progress.step(what);
        let rows = search(&trials, &effects, &joints, self.seed, &done)?;
        let checks: Vec<Check> = check(&trials, &rows, &joints, (self.seed, checked), &done)?;
        drop(progress);

        let document = json!({
            "command": "sensitivity",
            "experiment": self.experiment,
            "seed": self.seed,
            "unit": unit.symbol(),
            "added_to": subject.split.presence,
            "left_rms": subject.injection.model().left_rms(),
            "strengths": LEVELS,
            "draws": DRAWS,
            "named_in": NAMED_IN,
            "said_of_recordings_as_they_are": prepared.verdict().verdict,
            "limits": rows,
            "checks": checks,
        });
        let answered = Answered {
            rows: &rows,
            checks: &checks,
            subject: &subject,
            said: prepared.verdict().verdict,
            seed: self.seed,
            document: &document,
        };
        let page = answered.page();
        let mut outputs = Outputs::default();
        outputs.folder(
            &folder,
            [
                (RESULTS.to_owned(), pretty(&document).into_bytes()),
                (reports::FILE.to_owned(), page.to_html().into_bytes()),
            ],
        );
        outputs.figures(&page, plots.as_ref());
        let written = outputs.paths();
        outputs.write()?;
        let mut text = answered.text();
        text.push_str(&super::run::written_text(&written));
        Ok(Report { text, json: document, findings: false })
    }

    fn joints(&self, available: usize) -> Result<Vec<usize>, Failure> {
        if self.joints.is_empty() {
            return Ok((0..available).collect());
        }
        if let Some(joint) = self.joints.iter().find(|j| **j >= available) {
            return Err(Failure::argument(
                "--joints",
                format!("there is no joint {joint}"),
                format!("joints count from 0; the robot has {available}: 0 to {}", available - 1),
            ));
        }
        let mut joints = self.joints.clone();
        joints.sort_unstable();
        joints.dedup();
        Ok(joints)
    }
}
