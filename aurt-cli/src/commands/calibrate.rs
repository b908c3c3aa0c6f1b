//! `aurt calibrate`: coefficients from recordings (paper, section II-C).

use std::path::PathBuf;
use std::sync::Arc;

use aurt::Role;
use aurt::data::Source;
use aurt::fitting::{Assigned, Detail};
use aurt::origins::Origins;
use aurt_experiment::workbench::failure::Failure;
use aurt_experiment::workbench::output::{OutputFile, Outputs, distinct};
use aurt_experiment::workbench::streaming::{Bytes, TooLarge, fit_in_stretches};
use aurt_plugins::Registry;
use aurt_plugins::model::model_file::read_robot_model;
use aurt_plugins::model::{BASE_PARAMETER_SEED, RigidBodyDynamics};
use aurt_report::results::metrics::Results;
use aurt_report::results::parameters;
use aurt_traits::RobotModel;
use clap::Args;
use serde_json::json;

use super::Session;
use super::data_options::{FittingOptions, ReadingOptions};
use super::run::written_text;
use crate::rendering::terminal::Report;
use crate::values::{Gravity, parse_gravity};

/// Calibrate robot dynamics on recordings.
///
/// Recordings are tables with a header: a time column, positions `q_0 …`, currents `current_0 …` or torques
/// `torque_0 …` (and the names that robots log under). Several recordings are fitted together.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  aurt calibrate --model rd.json --data measured.csv --gravity 0 0 -9.81 \
    --out-params calibrated_parameters.csv --out-calibrated-model rd_calibrated.json")]
pub struct Calibrate {
    /// Robot dynamics from `aurt compile-rd`
    #[arg(long, value_name = "JSON")]
    model: PathBuf,
    /// Recordings
    #[arg(long, value_name = "RECORDING", num_args = 1.., required = true)]
    data: Vec<PathBuf>,
    /// Gravitational acceleration in the base frame, if other than the model was compiled for
    #[arg(long, value_name = "X Y Z", value_parser = parse_gravity, allow_hyphen_values = true)]
    gravity: Option<Gravity>,
    /// File for the parameters
    #[arg(long, value_name = "CSV")]
    out_params: PathBuf,
    /// File for the calibrated model
    #[arg(long, value_name = "JSON")]
    out_calibrated_model: PathBuf,
    /// Recordings larger than this in total are read in stretches, in constant memory
    #[arg(long, value_name = "SIZE", default_value = "500MB")]
    stream_above: Bytes,
    #[command(flatten)]
    reading: ReadingOptions,
    #[command(flatten)]
    fitting: FittingOptions,
}

impl Calibrate {
    pub fn run(&self, session: &Session<'_>) -> Result<Report, Failure> {
        let terminal = session.terminal;
        let mut inputs = vec![self.model.as_path()];
        inputs.extend(self.data.iter().map(PathBuf::as_path));
        let params = OutputFile::new("--out-params", &self.out_params, &inputs)?;
        let calibrated_model =
            OutputFile::new("--out-calibrated-model", &self.out_calibrated_model, &inputs)?;
        distinct(&[("--out-params", params.path()), ("--out-calibrated-model", calibrated_model.path())])?;

        let (model, notes) = model_under_gravity(&session.registry, &self.model, self.gravity)?;
        let job = self.fitting.job(model);
        let progress = terminal.progress(3 * self.data.len() + 1);
        let sources: Vec<Source> = self.data.iter().map(|f| self.reading.source(f)).collect();
        let together = Bytes::of_files(self.data.iter().map(PathBuf::as_path));
        let outcome = if together > self.stream_above {
            let because = TooLarge { together, limit: self.stream_above };
            let assigned: Vec<_> = sources.into_iter().map(|source| (source, Role::Calibration)).collect();
            fit_in_stretches(&job, &assigned, because, &progress)?
        } else {
            let assigned = job.read(sources, [], &progress)?;
            let mut outcome = job.fit(&assigned, Detail::Errors, &progress)?;
            outcome.calibrated.origins = Origins::of(None, assigned.iter().map(Assigned::origin));
            outcome
        };
        drop(progress);
        let calibrated = &outcome.calibrated;
        let mut outputs = Outputs::default();
        outputs.file(&params, parameters::to_csv(&calibrated.calibration.parameters));
        outputs.file(&calibrated_model, calibrated.to_file()?);
        outputs.write()?;

        let results = Results::of(&outcome, &notes);
        let written = [params.path(), calibrated_model.path()];
        let mut json = results.to_json();
        json["command"] = json!("calibrate");
        json["outputs"] = json!(written);
        Ok(Report {
            text: results.to_text(terminal.style()) + &written_text(&written),
            json,
            findings: false,
        })
    }
}

/// The robot model of a file, mounted as `gravity` says, and what there is to note about that.
pub fn model_under_gravity(
    registry: &Registry,
    path: &std::path::Path,
    gravity: Option<Gravity>,
) -> Result<(RobotModel, Vec<String>), Failure> {
    let model = read_robot_model(path, registry)?;
    let compiled = Gravity(model.rigid_body().gravity_m_s2());
    let Some(gravity) = gravity.filter(|g| *g != compiled) else { return Ok((model, Vec::new())) };
    let rigid_body = Arc::from(model.rigid_body().with_gravity(gravity.0));
    let mounted = RigidBodyDynamics::new(rigid_body, BASE_PARAMETER_SEED)?
        .with_joint_dynamics(model.stacks().to_vec(), model.arm_terms().to_vec())?;
    let note = format!(
        "the model was compiled for gravity {compiled}; for {gravity} its {} base parameters were found anew",
        mounted.base().len()
    );
    Ok((mounted, vec![note]))
}
