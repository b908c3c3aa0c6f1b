//! `aurt track`: how a machine has changed since its calibration.

use std::path::PathBuf;

use aurt::CalibratedModel;
use aurt_experiment::Experiment;
use aurt_experiment::workbench::failure::Failure;
use aurt_experiment::workbench::output::{OutputFolder, Outputs};
use aurt_experiment::workbench::reports::track;
use aurt_experiment::workbench::tracking::{
    Alarm, Followed, SHORTEST_WINDOW_S, TrackOptions, recordings_of, track,
};
use aurt_files::output::pretty;
use aurt_report::reports;
use clap::Args;
use serde_json::json;

use super::Session;
use super::data_options::JointOptions;
use super::plots::PlotOptions;
use crate::commands::run::delivered;
use crate::rendering::terminal::{Report, print_error};
use crate::values::parse_positive;

/// Follow a calibrated machine over time: drift of friction, gains and load, with alarms.
///
/// The recordings of the experiment show the unchanged machine and the usual variation of its estimates. Exit status 1
/// if something has changed; `aurt diagnose` with that recording as target identifies the cause.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  \
    aurt track experiment.toml --model results/rd_calibrated.json nightly --out track")]
pub struct Track {
    /// Experiment file; its recordings are the unchanged machine
    #[arg(value_name = "EXPERIMENT.toml")]
    experiment: PathBuf,
    /// Recordings in time order, folders of recordings (in the order of their names), or `-` for rows from standard input
    #[arg(value_name = "RECORDING", required = true)]
    recordings: Vec<PathBuf>,
    /// Calibrated robot dynamics from `aurt run` or `aurt calibrate`
    #[arg(long, value_name = "JSON")]
    model: PathBuf,
    /// Folder for report.html and track.json; created if it does not exist
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Length of the windows that are compared with the unchanged machine
    #[arg(long, value_name = "S", default_value = "5", value_parser = parse_positive)]
    window_s: f64,
    /// Mean time of recording between two false alarms of the whole arm
    #[arg(long, value_name = "H", default_value = "720", value_parser = parse_positive)]
    false_alarm_h: f64,
    /// Time of recording after which old friction counts half in the tracked estimate
    #[arg(long, value_name = "S", default_value = "60", value_parser = parse_positive)]
    friction_half_life_s: f64,
    /// The same for gains
    #[arg(long, value_name = "S", default_value = "120", value_parser = parse_positive)]
    gain_half_life_s: f64,
    /// The same for the load
    #[arg(long, value_name = "S", default_value = "20", value_parser = parse_positive)]
    load_half_life_s: f64,
    #[command(flatten)]
    joints: JointOptions,
    #[command(flatten)]
    plots: PlotOptions,
}

impl Track {
    pub fn run(&self, session: &mut Session<'_>) -> Result<Report, Failure> {
        let Session { terminal, registry, .. } = session;
        let folder = OutputFolder::new("--out", &self.out)?;
        let plots = self.plots.folder()?;
        if self.window_s < SHORTEST_WINDOW_S {
            return Err(Failure::argument(
                "--window-s",
                format!("{} s is too short to tell friction, gain and load apart", self.window_s),
                format!("choose {SHORTEST_WINDOW_S} s or more"),
            ));
        }
        let recordings: Vec<Followed> =
            recordings_of(&self.recordings)?.into_iter().map(Followed::File).collect();
        let experiment = Experiment::read(&self.experiment, registry)?;
        let calibrated = CalibratedModel::read(&self.model, registry)?;
        let options = TrackOptions {
            recorded: self.joints.recorded(),
            window_s: self.window_s,
            false_alarm_h: self.false_alarm_h,
            half_life_s: [self.friction_half_life_s, self.gain_half_life_s, self.load_half_life_s],
        };
        let own = experiment.recordings.calibration.len() + experiment.recordings.validation.len();
        let progress = terminal.progress(own + recordings.len());
        // Whoever watches a machine that runs on hears of an alarm at once, not when its rows end.
        let is_running = recordings.iter().any(Followed::is_running);
        let mut said = |alarm: &Alarm| {
            if is_running {
                print_error(&format!("alarm: {}\n", track::sentence(alarm)));
            }
        };
        let tracked = track(&experiment, &calibrated, registry, &recordings, options, &progress, &mut said)?;
        drop(progress);

        let mut document = json!(tracked);
        document["command"] = json!("track");
        document["experiment"] = json!(self.experiment);
        document["model"] = json!(self.model);
        let page = track::page(&tracked, &document);
        let mut outputs = Outputs::default();
        outputs.folder(
            &folder,
            [
                ("track.json".to_owned(), pretty(&document).into_bytes()),
                (reports::FILE.to_owned(), page.to_html().into_bytes()),
            ],
        );
        let (text, findings) = (track::text(&tracked), !tracked.alarms.is_empty());
        delivered(outputs, &page, plots.as_ref(), Report { text, json: document, findings })
    }
}
