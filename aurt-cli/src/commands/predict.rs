//! `aurt predict`: what a calibrated model says that a motion measures (paper, section II-D).

use std::path::PathBuf;
use std::sync::Arc;

use aurt::CalibratedModel;
use aurt::data::Purpose;
use aurt::origins::hash_of_file;
use aurt_calibration::extrapolations;
use aurt_experiment::workbench::driving::CalibratedDrive;
use aurt_experiment::workbench::failure::Failure;
use aurt_experiment::workbench::output::OutputFile;
use aurt_experiment::workbench::results::series::{Series, SeriesFormat};
use aurt_plugins::model::model_file::read_json;
use aurt_plugins::model::{BASE_PARAMETER_SEED, RigidBodyDynamics};
use aurt_report::rendering::text::wrapped;
use clap::Args;
use serde_json::json;

use super::Session;
use super::data_options::ReadingOptions;
use crate::rendering::terminal::{Emphasis, Report};
use crate::values::{Gravity, parse_gravity};

/// Predict currents or torques of a motion.
///
/// The motion needs a time column and positions, no measurement. The prediction has a row for each of its rows.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  aurt predict --model rd_calibrated.json --data trajectory.csv \
    --gravity 0 0 -9.81 --out predicted.csv")]
pub struct Predict {
    /// Calibrated robot dynamics from `aurt calibrate` or `aurt run`
    #[arg(long, value_name = "JSON")]
    model: PathBuf,
    /// The motion
    #[arg(long, value_name = "RECORDING")]
    data: PathBuf,
    /// Gravitational acceleration in the base frame, if other than the model was calibrated for
    #[arg(long, value_name = "X Y Z", value_parser = parse_gravity, allow_hyphen_values = true)]
    gravity: Option<Gravity>,
    /// File for the prediction: a text table, or `.parquet` or `.mcap` with positions, measurement and
    /// residual as well
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    #[command(flatten)]
    reading: ReadingOptions,
}

impl Predict {
    pub fn run(&self, session: &Session<'_>) -> Result<Report, Failure> {
        let out = OutputFile::new("--out", &self.out, &[&self.model, &self.data])?;
        // Once: it may be a pipe.
        let (document, text) = read_json(&self.model)?;
        if let Some(drive) = CalibratedDrive::from_document(&self.model, &document)? {
            return self.roll_out(drive, &out);
        }
        let blake3 = hash_of_file(&self.model).unwrap_or_default();
        let calibrated = CalibratedModel::from_document(&self.model, &document, &text, &session.registry)?;
        let calibrated = self.mounted(calibrated)?;
        let pipeline = calibrated.pipeline();
        let loaded = pipeline.read(self.reading.source(&self.data), Purpose::Prediction)?;
        let of_model = |failure: Failure| failure.of_value_in(&self.model);
        let contents = match SeriesFormat::of_ending(&self.out) {
            None => calibrated.predict_file(&loaded).map_err(|error| of_model(error.into()))?,
            Some(format) => {
                let facts = [("model", self.model.display().to_string()), ("model_blake3", blake3)];
                Series::of(&calibrated, &loaded).map_err(of_model)?.to_file(format, &self.data, &facts)?
            }
        };
        let prepared =
            pipeline.preprocess(&loaded, Purpose::Prediction).map_err(|error| of_model(error.into()))?;
        let mut warnings: Vec<String> = loaded.recording.report.warnings().collect();
        let mut notes = loaded.recording.report.notes();
        notes.retain(|note| !warnings.contains(note));
        notes.extend(prepared.data.report.notes());
        warnings.extend(extrapolations(&calibrated.model, &calibrated.calibration, &prepared)?);
        out.write(&contents)?;

        let unit = calibrated.calibration.unit;
        let rows = loaded.recording.report.rows;
        let mut text = format!(
            "{} of {} joints in {} for {rows} rows of {}\n",
            unit.quantity(),
            calibrated.model.joints(),
            unit.symbol(),
            self.data.display()
        );
        text.extend(notes.iter().map(|n| wrapped(&format!("note: {n}"))));
        let warning = session.terminal.emphasise(Emphasis::Warning, "warning");
        text.extend(warnings.iter().map(|w| wrapped(&format!("{warning}: {w}"))));
        text.push_str(&format!("written: {}\n", out.path().display()));
        let json = json!({
            "command": "predict",
            "rows": rows,
            "unit": unit.symbol(),
            "notes": notes,
            "warnings": warnings,
            "outputs": [out.path()],
        });
        Ok(Report { text, json, findings: false })
    }

    /// The positions to which commands lead, of a model with drives.
    fn roll_out(&self, mut drive: CalibratedDrive, out: &OutputFile) -> Result<Report, Failure> {
        if SeriesFormat::of_ending(&self.out).is_some() {
            let reason = "positions from commands are written as a text table".to_owned();
            return Err(Failure::argument("--out", reason, "end its name in .csv"));
        }
        if let Some(gravity) = self.gravity {
            drive.arm.chain = drive.arm.chain.under_gravity(gravity.0);
        }
        let (contents, notes) = drive.rollout_file(self.reading.source(&self.data))?;
        out.write(&contents)?;
        let joints = drive.arm.joints.len();
        let mut text = format!("positions of {joints} joints from the commands of {}\n", self.data.display());
        text.extend(notes.iter().map(|n| wrapped(&format!("note: {n}"))));
        text.push_str(&format!("written: {}\n", out.path().display()));
        let json = json!({ "command": "predict", "notes": notes, "outputs": [out.path()] });
        Ok(Report { text, json, findings: false })
    }

    /// The model on a base mounted as `--gravity` says, if its base parameters suffice there.
    fn mounted(&self, calibrated: CalibratedModel) -> Result<CalibratedModel, Failure> {
        let model = &calibrated.model;
        let known = Gravity(model.rigid_body().gravity_m_s2());
        let Some(gravity) = self.gravity.filter(|g| *g != known) else { return Ok(calibrated) };
        let rigid_body = Arc::from(model.rigid_body().with_gravity(gravity.0));
        let dynamics = RigidBodyDynamics::new(rigid_body, BASE_PARAMETER_SEED)?;
        let same = dynamics.base.columns == model.base().columns
            && dynamics.base.combinations.iter().zip(&model.base().combinations).all(|(a, b)| {
                a.len() == b.len()
                    && a.iter()
                        .zip(b)
                        .all(|((i, x), (k, y))| i == k && (x - y).abs() <= 1e-9 * y.abs().max(1.0))
            });
        if !same {
            return Err(Failure::argument(
                "--gravity",
                format!(
                    "{} was calibrated under gravity {known}, which determines {} base parameters; under {gravity} \
                     torques depend on {} of them",
                    self.model.display(),
                    model.base().len(),
                    dynamics.base.len()
                ),
                "calibrate on recordings of the robot mounted like that",
            ));
        }
        let model = dynamics.with_joint_dynamics(model.stacks().to_vec(), model.arm_terms().to_vec())?;
        Ok(CalibratedModel { model, ..calibrated })
    }
}
