//! `aurt calibrate-validate`: calibrate on the first part of a recording, validate on the rest (paper, section
//! II-C).

use std::path::PathBuf;

use aurt::Role;
use aurt::data::{Loaded, Source};
use aurt::fitting::{Assigned, Detail};
use aurt_experiment::workbench::failure::Failure;
use aurt_experiment::workbench::output::{OutputFile, Outputs, distinct};
use aurt_report::reports;
use aurt_report::results::metrics::Results;
use aurt_report::results::parameters;
use clap::Args;
use serde_json::json;

use super::Session;
use super::calibrate::model_under_gravity;
use super::data_options::{FittingOptions, ReadingOptions};
use super::plots::PlotOptions;
use super::run::delivered;
use crate::rendering::terminal::Report;
use crate::values::{Gravity, parse_gravity, parse_share};

/// Calibrate on the first part of a recording and validate on the rest.
///
/// The prediction covers the whole recording.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  aurt calibrate-validate --model rd.json --data measured.csv \
    --gravity 0 0 -9.81 --calibration-data-rel 0.7 --out-params calibrated_parameters.csv \
    --out-calibrated-model rd_calibrated.json --out-prediction predicted.csv")]
pub struct CalibrateValidate {
    /// Robot dynamics from `aurt compile-rd`
    #[arg(long, value_name = "JSON")]
    model: PathBuf,
    /// Recording
    #[arg(long, value_name = "RECORDING")]
    data: PathBuf,
    /// Gravitational acceleration in the base frame, if other than the model was compiled for
    #[arg(long, value_name = "X Y Z", value_parser = parse_gravity, allow_hyphen_values = true)]
    gravity: Option<Gravity>,
    /// Share of the samples, from the first, that calibrate; the others validate
    #[arg(long, value_name = "SHARE", value_parser = parse_share)]
    calibration_data_rel: f64,
    /// File for the parameters
    #[arg(long, value_name = "CSV")]
    out_params: PathBuf,
    /// File for the calibrated model
    #[arg(long, value_name = "JSON")]
    out_calibrated_model: PathBuf,
    /// File for the prediction
    #[arg(long, value_name = "CSV")]
    out_prediction: PathBuf,
    /// File for the report; by default report.html beside the calibrated model
    #[arg(long, value_name = "HTML")]
    out_report: Option<PathBuf>,
    #[command(flatten)]
    plots: PlotOptions,
    #[command(flatten)]
    reading: ReadingOptions,
    #[command(flatten)]
    fitting: FittingOptions,
}

impl CalibrateValidate {
    pub fn run(&self, session: &Session<'_>) -> Result<Report, Failure> {
        let terminal = session.terminal;
        let inputs = [self.model.as_path(), self.data.as_path()];
        let params = OutputFile::new("--out-params", &self.out_params, &inputs)?;
        let calibrated_model =
            OutputFile::new("--out-calibrated-model", &self.out_calibrated_model, &inputs)?;
        let prediction = OutputFile::new("--out-prediction", &self.out_prediction, &inputs)?;
        let beside = || self.out_calibrated_model.with_file_name(reports::FILE);
        let report_path = self.out_report.clone().unwrap_or_else(beside);
        let report = OutputFile::new("--out-report", &report_path, &inputs)?;
        let plots = self.plots.folder()?;
        distinct(&[
            ("--out-params", params.path()),
            ("--out-calibrated-model", calibrated_model.path()),
            ("--out-prediction", prediction.path()),
            ("--out-report", report.path()),
        ])?;

        let (model, notes) = model_under_gravity(&session.registry, &self.model, self.gravity)?;
        let job = self.fitting.job(model);
        let progress = terminal.progress(6);
        let whole = job.read([self.reading.source(&self.data)], [], &progress)?;
        let assigned: Vec<Assigned> =
            whole.iter().flat_map(|a| split(&a.loaded, self.calibration_data_rel)).collect();
        let mut outcome = job.fit(&assigned, Detail::RowByRow, &progress)?;
        drop(progress);
        // Both parts are of one file, and the prediction is for all of it.
        outcome
            .recordings
            .iter_mut()
            .for_each(|r| r.prediction = Some(prediction.path().display().to_string()));
        let calibrated = &outcome.calibrated;
        let mut outputs = Outputs::default();
        outputs.file(&params, parameters::to_csv(&calibrated.calibration.parameters));
        outputs.file(&calibrated_model, calibrated.to_file()?);
        if let Some((_, contents)) = outcome.predictions.pop() {
            outputs.file(&prediction, contents);
        }

        let results = Results::of(&outcome, &notes);
        let mut json = results.to_json();
        let page = reports::calibration::page("calibrate-validate", &results, None, &json);
        outputs.file(&report, page.to_html().into_bytes());
        json["command"] = json!("calibrate-validate");
        json["calibration_data_rel"] = json!(self.calibration_data_rel);
        let text = results.to_text(terminal.style());
        delivered(outputs, &page, plots.as_ref(), Report { text, json, findings: false })
    }
}

/// The first `share` of a recording's samples for calibration, the others for validation.
fn split(loaded: &Loaded, share: f64) -> [Assigned; 2] {
    let time = &loaded.recording.time_s;
    let last = time.len().saturating_sub(1);
    let first_of_rest = ((share * time.len() as f64).round() as usize).clamp(1.min(last), last);
    let since_start = |sample: usize| time.get(sample).zip(time.first()).map_or(0.0, |(t, start)| t - start);
    let part = |window: [f64; 2], role| Assigned {
        loaded: Loaded {
            source: Source { window_s: Some(window), ..loaded.source.clone() },
            recording: loaded.recording.clone(),
        },
        role,
    };
    [
        part([0.0, since_start(first_of_rest.saturating_sub(1))], Role::Calibration),
        part([since_start(first_of_rest), since_start(last)], Role::Validation),
    ]
}
