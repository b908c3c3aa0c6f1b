//! `aurt run`: the whole chain from one experiment file.

use std::path::{Path, PathBuf};

use aurt::Outcome;
use aurt_experiment::Experiment;
use aurt_experiment::workbench::driving::{DriveOutcome, fit_drives};
use aurt_experiment::workbench::experiments::{fit_and_keep, job};
use aurt_experiment::workbench::failure::Failure;
use aurt_experiment::workbench::output::{OutputFolder, Outputs};
use aurt_experiment::workbench::results::series::{self, SeriesFormat};
use aurt_experiment::workbench::streaming::{Bytes, TooLarge, fit_experiment_in_stretches};
use aurt_files::output::pretty;
use aurt_rbd::RobotDescription;
use aurt_report::rendering::style::Style;
use aurt_report::results::metrics::Results;
use aurt_report::results::parameters;
use aurt_report::{Page, reports};
use clap::Args;
use serde_json::{Value, json};

use super::Session;
use super::checked_setup::doubts;
use super::plots::PlotOptions;
use crate::rendering::terminal::Report;
use crate::values::{Choice, choice};

/// Calibrate and validate the model of an experiment file.
///
/// Reads the recordings, compiles and calibrates the model, evaluates it on every recording and writes
/// rd_calibrated.json, calibrated_parameters.csv, metrics.json, report.html and a prediction for every
/// recording.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  aurt run experiment.toml --out results")]
pub struct Run {
    /// Experiment file
    #[arg(value_name = "EXPERIMENT.toml")]
    experiment: PathBuf,
    /// Folder for the results; created if it does not exist
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Recordings larger than this in total are read in stretches, in constant memory, without predictions
    /// row by row and without the check for setup mistakes
    #[arg(long, value_name = "SIZE", default_value = "500MB")]
    stream_above: Bytes,
    /// Also write positions, measurement, prediction and residual of every recording in this format, as
    /// series_<recording>.parquet or .mcap
    #[arg(long, value_parser = choice(SERIES), value_name = "FORMAT")]
    series: Option<SeriesFormat>,
    #[command(flatten)]
    plots: PlotOptions,
}

pub const SERIES: &[Choice<SeriesFormat>] = &[
    ("parquet", "Apache Parquet: pandas, Polars, DuckDB", SeriesFormat::Parquet),
    ("mcap", "MCAP with joint states of ROS 2: Foxglove, rerun, PlotJuggler", SeriesFormat::Mcap),
];

impl Run {
    pub fn run(&self, session: &mut Session<'_>) -> Result<Report, Failure> {
        let folder = OutputFolder::new("--out", &self.out)?;
        let plots = self.plots.folder()?;
        let experiment = Experiment::read_with_drives(&self.experiment, &mut session.registry)?;
        let count = experiment.recordings.calibration.len() + experiment.recordings.validation.len();
        if experiment.drive.is_some() {
            let outcome = fit_drives(&experiment, &session.terminal.progress(2 * count + 1))?;
            return write_drives("run", outcome, &folder);
        }
        let progress = session.terminal.progress(3 * count + 3);
        let recordings = &experiment.recordings;
        let together = Bytes::of_files(
            recordings.calibration.iter().chain(&recordings.validation).map(|r| r.file.as_path()),
        );
        if together > self.stream_above {
            if self.series.is_some() {
                return Err(Failure::argument(
                    "--series",
                    "needs the recordings in memory, and they are read in stretches",
                    format!("raise --stream-above beyond {together}"),
                ));
            }
            let because = TooLarge { together, limit: self.stream_above };
            let outcome = fit_experiment_in_stretches(&experiment, because, &progress)
                .map_err(|failure| failure.of_value_in(&experiment.path))?;
            drop(progress);
            let style = session.terminal.style();
            return RunFiles::new("run", &experiment, &outcome, style)?.write(
                outcome,
                &folder,
                plots.as_ref(),
            );
        }
        let (mut outcome, recordings) =
            fit_and_keep(&experiment, &progress).map_err(|failure| failure.of_value_in(&experiment.path))?;
        if let Some(format) = self.series {
            let series = series::files(&job(&experiment)?, &outcome.calibrated, &recordings, format)?;
            outcome.predictions.extend(series);
        }
        progress.step("looking for mistakes of the setup");
        let style = session.terminal.style();
        let (doubts, results) = rayon::join(
            || doubts(&experiment, &outcome.recordings, recordings, &session.registry),
            || RunFiles::new("run", &experiment, &outcome, style),
        );
        drop(progress);
        let doubts = doubts?;
        let mut report = results?.write(outcome, &folder, plots.as_ref())?;
        doubts.add_to(&mut report, session.terminal);
        Ok(report)
    }
}

/// Fills `folder` with what was found of drives and reports it.
pub fn write_drives(command: &str, outcome: DriveOutcome, folder: &OutputFolder) -> Result<Report, Failure> {
    let DriveOutcome { text, mut json, files, findings } = outcome;
    let mut outputs = Outputs::default();
    outputs.folder(folder, files);
    let written = outputs.paths();
    outputs.write()?;
    json["command"] = json!(command);
    json["outputs"] = json!(written);
    Ok(Report { text: text + &written_text(&written), json, findings })
}

/// What is written of an outcome beside its predictions, and said of it.
pub struct RunFiles {
    text: String,
    metrics: Value,
    page: Page,
    files: Vec<(String, Vec<u8>)>,
}

impl RunFiles {
    pub fn new(
        command: &str,
        experiment: &Experiment,
        outcome: &Outcome,
        style: Style,
    ) -> Result<Self, Failure> {
        let calibrated = &outcome.calibrated;
        let mut notes = experiment.robot.geometry.notes();
        notes.extend(experiment.notes.clone());
        let results = Results::of(outcome, &notes);
        let mut metrics = results.to_json();
        let page = reports::calibration::page(command, &results, Some(&experiment.source_text), &metrics);
        let files = vec![
            (reports::FILE.to_owned(), page.to_html().into_bytes()),
            ("rd_calibrated.json".to_owned(), calibrated.to_file()?),
            ("calibrated_parameters.csv".to_owned(), parameters::to_csv(&calibrated.calibration.parameters)),
            ("metrics.json".to_owned(), pretty(&metrics).into_bytes()),
        ];
        metrics["command"] = json!(command);
        Ok(Self { text: results.to_text(style), metrics, page, files })
    }

    pub fn write(
        self,
        outcome: Outcome,
        folder: &OutputFolder,
        plots: Option<&OutputFolder>,
    ) -> Result<Report, Failure> {
        let Self { text, metrics: json, page, mut files } = self;
        files.extend(outcome.predictions);
        let mut outputs = Outputs::default();
        outputs.folder(folder, files);
        delivered(outputs, &page, plots, Report { text, json, findings: false })
    }
}

/// Writes outputs with the figures of a page, and says at the end of a report where they are.
pub fn delivered(
    mut outputs: Outputs,
    page: &Page,
    plots: Option<&OutputFolder>,
    mut report: Report,
) -> Result<Report, Failure> {
    let mut written = outputs.paths();
    let drawn = outputs.figures(page, plots);
    outputs.write()?;
    report.text += &(written_text(&written) + &drawn_text(&drawn, plots));
    written.extend(drawn);
    report.json["outputs"] = json!(written);
    Ok(report)
}

/// What a command wrote, for people.
pub fn written_text(files: &[impl AsRef<Path>]) -> String {
    let lines: Vec<String> = files.iter().map(|f| format!("  {}\n", f.as_ref().display())).collect();
    format!("\nwritten\n{}", lines.concat())
}

/// Where the figures are, for people.
pub fn drawn_text(drawn: &[PathBuf], plots: Option<&OutputFolder>) -> String {
    plots.map_or_else(String::new, |folder| {
        format!("  {} figures in {}\n", drawn.len(), folder.path().display())
    })
}
