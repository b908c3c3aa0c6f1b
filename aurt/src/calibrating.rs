//! Calibrating recordings in memory.

use aurt_calibration::{CalibrationOptions, Prediction, TermScopes, predict};
use aurt_files::output::write_file;
use aurt_plugins::Registry;
use aurt_recording::{PreprocessOptions, Recording};
use aurt_traits::RobotModel;
use std::path::Path;

use crate::calibrated_file::CalibratedModel;
use crate::data::{Instrument, Loaded, Purpose};
use crate::error::Error;
use crate::fitting::{Assigned, Detail, Job, Outcome};
use crate::predictions::at_stamps;
use crate::predictor::Predictor;
use crate::progress::Progress;
use crate::role::Role;

/// How recordings are preprocessed and coefficients found.
#[derive(Debug, Clone, Default)]
pub struct Settings {
    /// Clock, filters, decimation.
    pub preprocessing: PreprocessOptions,
    /// What measuring does to the quantity that the model is about; it is undone.
    pub instrument: Instrument,
    /// How coefficients are found.
    pub calibration: CalibrationOptions,
}

/// A calibration of recordings in memory.
///
/// ```no_run
/// use aurt::prelude::*;
///
/// # fn main() -> Result<(), aurt::Error> {
/// let robot = Robot::read_mdh("mdh.csv", [0.0, 0.0, -9.81])?;
/// let outcome = Calibrator::new(robot.model().friction(Friction::load_dependent().viscous(1)).build()?)
///     .calibration(&Recording::read("monday.csv")?)
///     .validation(&Recording::read("tuesday.csv")?)
///     .calibrate()?;
/// outcome.calibrated.save("rd_calibrated.json")?;
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Calibrator {
    model: RobotModel,
    settings: Settings,
    recordings: Vec<(Recording, Role)>,
}

impl Calibrator {
    /// A calibration of a model.
    pub fn new(model: RobotModel) -> Self {
        Self { model, settings: Settings::default(), recordings: Vec::new() }
    }

    /// How recordings are preprocessed and coefficients found.
    #[must_use]
    pub fn settings(self, settings: Settings) -> Self {
        Self { settings, ..self }
    }

    /// Adds a recording that the model is fitted to.
    #[must_use]
    pub fn calibration(mut self, recording: &Recording) -> Self {
        self.recordings.push((recording.clone(), Role::Calibration));
        self
    }

    /// Adds a recording that is held out, for judging the model.
    #[must_use]
    pub fn validation(mut self, recording: &Recording) -> Self {
        self.recordings.push((recording.clone(), Role::Validation));
        self
    }

    /// Fits the model and judges it on every recording.
    ///
    /// # Errors
    /// What makes a recording unfit or the fit impossible; joints that are not the robot's.
    pub fn calibrate(self) -> Result<Outcome, Error> {
        self.run(Detail::Errors, &Progress::silent())
    }

    /// The same with the comparison of prediction and measurement row by row, which reports show; `progress` is told what
    /// is being done.
    ///
    /// # Errors
    /// As [`Self::calibrate`].
    pub fn calibrate_with_series(self, progress: &Progress) -> Result<Outcome, Error> {
        self.run(Detail::Compared, progress)
    }

    fn run(self, detail: Detail, progress: &Progress) -> Result<Outcome, Error> {
        let job = Job {
            model: self.model,
            preprocessing: self.settings.preprocessing,
            instrument: self.settings.instrument,
            options: self.settings.calibration,
            scopes: TermScopes::default(),
        };
        let joints = job.pipeline().joints;
        let recordings = self.recordings.iter();
        let assigned =
            recordings.map(|(r, role)| Ok(Assigned { loaded: Loaded::of(r, &joints)?, role: *role }));
        job.fit(&assigned.collect::<Result<Vec<_>, Error>>()?, detail, progress)
    }
}

impl CalibratedModel {
    /// Reads a file that [`Self::save`], `aurt calibrate` or `aurt run` wrote, of linked models.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn load(path: impl AsRef<Path>) -> Result<Self, Error> {
        Self::read(path.as_ref(), &Registry::linked()?)
    }

    /// Writes the model into a file, which appears whole or not at all.
    ///
    /// # Errors
    /// If a model cannot be expressed in JSON, or the file not be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        Ok(write_file(path.as_ref(), &self.to_file()?)?)
    }

    /// Predictions for a recording, preprocessed as the model's own were, one for each stretch without gaps.
    ///
    /// # Errors
    /// What makes the recording unfit.
    pub fn predict(&self, recording: &Recording) -> Result<Vec<Prediction>, Error> {
        let pipeline = self.pipeline();
        let prepared = pipeline.preprocess(&Loaded::of(recording, &pipeline.joints)?, Purpose::Prediction)?;
        Ok(predict(&self.model, &self.calibration, &prepared)?)
    }

    /// The prediction for every stamp of a recording, as `[joint][sample]`; see [`at_stamps`].
    ///
    /// # Errors
    /// What makes the recording unfit.
    pub fn predict_at_stamps(&self, recording: &Recording) -> Result<Vec<Vec<f64>>, Error> {
        Ok(at_stamps(&recording.time_s, &self.predict(recording)?))
    }

    /// A predictor for single samples, in a control loop.
    ///
    /// # Errors
    /// As [`Predictor::new`].
    pub fn predictor(&self) -> Result<Predictor, Error> {
        Predictor::new(&self.model, &self.calibration)
    }
}
