//! `aurt diagnose`: where a model and recordings differ, what physics is missing, and the model that has it.

use std::path::PathBuf;

use aurt::Progress;
use aurt_diagnosis::drives::STRUCTURES;
use aurt_diagnosis::{Learnt, effects};
use aurt_experiment::Experiment;
use aurt_experiment::doctor::mistakes::{self, Examination, Subject};
use aurt_experiment::workbench::described_model::{ChainEnds, GivenModel};
use aurt_experiment::workbench::diagnosing::{DiagnosisOptions, MOST_ROWS, diagnose_experiment};
use aurt_experiment::workbench::driving::{diagnose_drives, second_opinion};
use aurt_experiment::workbench::failure::Failure;
use aurt_experiment::workbench::output::{OutputFolder, Outputs};
use aurt_experiment::workbench::results::diagnosed_series;
use aurt_experiment::workbench::results::series::SeriesFormat;
use aurt_files::output::pretty;
use aurt_plugins::{Registry, suggestion};
use aurt_report::rendering::text::wrapped;
use aurt_report::reports;
use clap::Args;
use serde_json::json;

use super::Session;
use super::plots::PlotOptions;
use super::run::write_drives;
use crate::commands::run::{SERIES, drawn_text, written_text};
use crate::rendering::terminal::{Report, Terminal};
use crate::values::choice;

/// Locate the mismatch between a model and recordings, name the missing physics, and model it.
///
/// With `[recordings] target`, reports what the targets show beyond the model; without, what the model
/// lacks in its calibration recordings. With `[drive]`, reports which structures of drives and joints the
/// held-out positions need, and which the model lacks. Exit status 1 if something was found.
#[derive(Debug, Default, Args)]
#[command(after_help = "Example:\n  aurt diagnose experiment.toml --out diagnosis\n  \
    aurt diagnose experiment.toml --model results/rd_calibrated.json --out diagnosis\n  \
    aurt diagnose experiment.toml --model robot.urdf --out diagnosis\n  \
    aurt diagnose servo.toml --model actuators.xml --out opinion")]
pub struct Diagnose {
    /// Experiment file
    #[arg(value_name = "EXPERIMENT.toml")]
    experiment: PathBuf,
    /// Folder for report.html, verdict.json, improved.toml and rd_improved.json; created if it does not exist
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Take a model as given instead of recalibrating the experiment's structure: a calibrated one, or the inertial
    /// parameters, friction and rotors that a URDF or MJCF file states. With `[drive]`, a fit of another program is tested:
    /// an MJCF file with actuators, BAM's JSON, or settings of Isaac Lab's actuators or PACE's result as JSON
    #[arg(long, value_name = "RD_CALIBRATED.json|URDF|XML")]
    model: Option<PathBuf>,
    /// The link of the URDF or MJCF file that the chain starts from
    #[arg(long, value_name = "LINK", requires = "model")]
    base: Option<String>,
    /// The link of the URDF or MJCF file that the chain ends at
    #[arg(long, value_name = "LINK", requires = "model")]
    tip: Option<String>,
    /// Correct the URDF or MJCF file of --model by what mujoco.sysid identified: its params_x_hat.yaml
    #[arg(long, value_name = "PARAMS.yaml", requires = "model")]
    parameters: Option<PathBuf>,
    /// Exclude an effect from the diagnosis; may be given several times
    #[arg(long, value_name = "EFFECT")]
    without: Vec<String>,
    /// Examine these effects alone; may be given several times
    #[arg(long, value_name = "EFFECT", conflicts_with = "without")]
    only: Vec<String>,
    /// Take confidence from this file of `aurt-lab prove --learn` instead of the program's own
    #[arg(long, value_name = "LEARNT.json")]
    learnt: Option<PathBuf>,
    /// Write the verdict alone: no report, no improved experiment, no improved model
    #[arg(long, conflicts_with = "plots")]
    verdict_only: bool,
    /// Also write measurement, predictions and residuals of every recording, without and with the claimed
    /// effects, and the located windows, as series_<recording>.parquet or .mcap
    #[arg(long, value_parser = choice(SERIES), value_name = "FORMAT")]
    series: Option<SeriesFormat>,
    /// Use at most this many rows of all recordings; of longer recordings evenly spread stretches are used
    #[arg(long, value_name = "ROWS", default_value_t = MOST_ROWS)]
    most_rows: usize,
    #[command(flatten)]
    plots: PlotOptions,
}

impl Diagnose {
    /// A diagnosis of an experiment with all effects, its outputs in `out`.
    pub fn new(experiment: PathBuf, out: PathBuf) -> Self {
        Self { experiment, out, most_rows: MOST_ROWS, ..Self::default() }
    }

    pub fn run(&self, session: &mut Session<'_>) -> Result<Report, Failure> {
        let Session { terminal, registry, .. } = session;
        let learnt = self.learnt.as_deref().map(Learnt::read).transpose()?;
        let terminal: &Terminal = terminal;
        let folder = OutputFolder::new("--out", &self.out)?;
        let plots = self.plots.folder()?;
        let experiment = Experiment::read_with_drives(&self.experiment, registry)?;
        if experiment.drive.is_some() {
            return self.drives(&experiment, &folder, &terminal.progress(48));
        }
        let ends = ChainEnds { base: self.base.as_deref(), tip: self.tip.as_deref() };
        let read = |model| GivenModel::read(model, ends, self.parameters.as_deref(), &experiment, registry);
        let given = self.model.as_deref().map(read);
        let given = given.transpose()?;
        let notes = given.as_ref().map_or_else(Vec::new, |given| given.notes.clone());
        let improve_for = (!self.verdict_only).then(|| folder.path().to_owned());
        let options = DiagnosisOptions {
            frozen: given.map(|given| given.calibrated),
            without: self.excluded(registry)?,
            learnt,
            improve_for,
            series: self.series.is_some(),
            most_rows: Some(self.most_rows),
        };
        let progress = terminal.progress(24);
        let diagnosis = diagnose_experiment(&experiment, registry, &options, &progress)?;
        drop(progress);

        let mut files = vec![("verdict.json".to_owned(), pretty(&diagnosis.document).into_bytes())];
        if let Some(improved) = &diagnosis.improved {
            files.extend([
                (reports::FILE.to_owned(), improved.report.to_html().into_bytes()),
                ("improved.toml".to_owned(), improved.experiment_toml.clone().into_bytes()),
                ("rd_improved.json".to_owned(), improved.model.to_file()?),
            ]);
        }
        if let Some(format) = self.series {
            files.extend(diagnosed_series::files(&diagnosis.series, &diagnosis.verdict, format)?);
        }
        let mut outputs = Outputs::default();
        outputs.folder(&folder, files);
        let mut written = outputs.paths();
        let figures = diagnosis.improved.as_ref().map(|i| outputs.figures(&i.report, plots.as_ref()));
        outputs.write()?;
        let mut text = diagnosis.to_text(terminal.style());
        let setup = if self.verdict_only { None } else { mistaken(&experiment, registry)? };
        if let Some(examination) = &setup {
            text = format!("{}\n{text}", examination.to_text(terminal.style()).trim_start());
        }
        text.extend(notes.iter().map(|note| wrapped(&format!("note: {note}"))));
        if let Some(improved) = &diagnosis.improved {
            text.extend(improved.notes.iter().map(|note| wrapped(&format!("note: {note}"))));
            text.push_str(&difference(&improved.added));
        }
        text.push_str(&written_text(&written));
        if let Some(drawn) = figures {
            text.push_str(&drawn_text(&drawn, plots.as_ref()));
            written.extend(drawn);
        }
        let mut json = diagnosis.document.clone();
        json["command"] = json!("diagnose");
        let improved = diagnosis.improved.iter().flat_map(|i| &i.model.calibration.warnings);
        json["warnings"] = json!(diagnosis.verdict.warnings.iter().chain(improved).collect::<Vec<_>>());
        json["notes"] = json!(notes);
        json["outputs"] = json!(written);
        json["setup"] = json!(setup.as_ref().map(Examination::to_json));
        Ok(Report { text, json, findings: diagnosis.is_found() || setup.is_some() })
    }
}

impl Diagnose {
    fn drives(
        &self,
        experiment: &Experiment,
        folder: &OutputFolder,
        progress: &Progress,
    ) -> Result<Report, Failure> {
        let unused = [
            ("--base", self.base.is_some()),
            ("--tip", self.tip.is_some()),
            ("--learnt", self.learnt.is_some()),
            ("--series", self.series.is_some()),
            ("--plots", self.plots.folder()?.is_some()),
        ];
        if let Some((option, _)) = unused.into_iter().find(|(_, given)| *given) {
            let reason = "is of recordings with torques, and this experiment has a [drive]";
            return Err(Failure::argument(option, reason, "leave it out"));
        }
        if let Some(file) = &self.model {
            let chosen = [("--without", &self.without), ("--only", &self.only)];
            if let Some((option, _)) = chosen.into_iter().find(|(_, names)| !names.is_empty()) {
                let reason = "chooses structures, and with `--model` the fit is judged as it is";
                return Err(Failure::argument(option, reason, "leave it out"));
            }
            return write_drives(
                "diagnose",
                second_opinion(experiment, file, self.parameters.as_deref(), progress)?,
                folder,
            );
        }
        let known: Vec<&str> = STRUCTURES.iter().map(|s| s.id).collect();
        let without = self.left_out(&known, "structure")?;
        write_drives("diagnose", diagnose_drives(experiment, &without, progress)?, folder)
    }

    /// The effects and registered models that are not examined.
    fn excluded(&self, registry: &Registry) -> Result<Vec<String>, Failure> {
        let models = registry.models().map(|m| m.name.as_str());
        let known: Vec<&str> = effects::ALL.into_iter().map(|e| e.id).chain(models).collect();
        self.left_out(&known, "effect or registered model")
    }

    fn left_out(&self, known: &[&str], kind: &str) -> Result<Vec<String>, Failure> {
        let (option, names) =
            if self.only.is_empty() { ("--without", &self.without) } else { ("--only", &self.only) };
        if let Some(name) = names.iter().find(|name| !known.contains(&name.as_str())) {
            let meant = suggestion::likely(name, known.iter().copied());
            let meant = meant.map_or_else(String::new, |k| format!("did you mean `{k}`? "));
            return Err(Failure::argument(
                option,
                format!("there is no {kind} `{name}`"),
                if kind == "structure" {
                    format!("{meant}known: {}", known.join(", "))
                } else {
                    format!("{meant}`aurt explain` lists what there is")
                },
            ));
        }
        if self.only.is_empty() {
            return Ok(self.without.clone());
        }
        let left = known.iter().filter(|name| !self.only.iter().any(|only| only == *name));
        Ok(left.map(|name| (*name).to_owned()).collect())
    }
}

/// What is wrong with the setup that physics would be invented for, if anything clearly is.
fn mistaken(experiment: &Experiment, registry: &Registry) -> Result<Option<Examination>, Failure> {
    let subject = Subject::of_experiment(experiment, mistakes::recordings_of(experiment)?)?;
    let examination = mistakes::examine_calibrated(&subject, &[], registry)?;
    Ok(Some(examination).filter(Examination::is_serious))
}

/// The lines that the improved experiment has and the original has not.
fn difference(added: &[String]) -> String {
    if added.is_empty() {
        return String::new();
    }
    format!(
        "\nadded to the experiment (joints count from 0)\n{}",
        added.iter().map(|l| format!("  + {l}\n")).collect::<String>()
    )
}
