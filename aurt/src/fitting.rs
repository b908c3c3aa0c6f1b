//! The chain from recordings to a judged model: read, preprocess, calibrate, validate, predict.

use aurt_calibration::{
    Calibration, CalibrationError, CalibrationOptions, Comparison, NamedRecording, ShapeOptions, TermScopes,
    ValidatedRows, calibrate_shapes, compare, predict, validate,
};
use aurt_recording::RobotJoints;
use aurt_traits::RobotModel;
use rayon::prelude::*;

use crate::calibrated_file::CalibratedModel;
use crate::data::{Instrument, Loaded, Pipeline, Preprocessing, Purpose, Source};
use crate::duplicates::SampleRegister;
use crate::error::Error;
use crate::origins::Origins;
use crate::predictions::{PredictionNames, to_csv};
use crate::progress::Progress;
use crate::role::{RecordingResult, Role};

/// What is to be done.
#[derive(Debug, Clone)]
pub struct Job {
    /// The model whose coefficients are wanted.
    pub model: RobotModel,
    /// How recordings are preprocessed.
    pub preprocessing: Preprocessing,
    /// What is undone in their measurements.
    pub instrument: Instrument,
    /// How the coefficients are found.
    pub options: CalibrationOptions,
    /// In which recordings each arm term acts.
    pub scopes: TermScopes,
}

/// What is to be known of a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Detail {
    /// The model and its errors.
    Errors,
    /// Also the comparison of prediction and measurement, row by row.
    Compared,
    /// Also the prediction for every file and its comparison with the measurement, row by row.
    RowByRow,
}

/// A recording with what it is for.
#[derive(Debug, Clone)]
pub struct Assigned {
    /// The recording, read.
    pub loaded: Loaded,
    /// What it is for.
    pub role: Role,
}

impl Assigned {
    /// Where it is from.
    pub const fn origin(&self) -> (&Source, Role) {
        (&self.loaded.source, self.role)
    }
}

/// A file's name and contents.
pub type NamedTable = (String, Vec<u8>);

/// A calibrated model with its errors and predictions.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// The model.
    pub calibrated: CalibratedModel,
    /// How it does on each recording, in their order.
    pub recordings: Vec<RecordingResult>,
    /// Predictions for each file.
    pub predictions: Vec<NamedTable>,
}

impl Role {
    /// What recordings of this part are preprocessed for.
    pub const fn purpose(self) -> Purpose {
        match self {
            Self::Calibration => Purpose::Calibration,
            Self::Validation => Purpose::Validation,
        }
    }
}

/// The rows by which a model is judged: the fit by all that it was fitted to; on a held-out recording those in which
/// the robot stands before and after the motion are left out, as they are in calibration.
pub const fn judged_rows(role: Role, trim_rest: bool) -> ValidatedRows {
    match role {
        Role::Validation if trim_rest => ValidatedRows::WhileInMotion,
        Role::Validation | Role::Calibration => ValidatedRows::All,
    }
}

impl Job {
    /// How recordings are read and preprocessed.
    pub fn pipeline(&self) -> Pipeline<'_> {
        Pipeline {
            joints: RobotJoints::of(&**self.model.rigid_body()),
            preprocessing: &self.preprocessing,
            instrument: &self.instrument,
        }
    }

    /// Reads recordings, calibration before validation.
    ///
    /// # Errors
    /// What is wrong with a file.
    pub fn read(
        &self,
        calibration: impl IntoIterator<Item = Source>,
        validation: impl IntoIterator<Item = Source>,
        progress: &Progress,
    ) -> Result<Vec<Assigned>, Error> {
        let assign = |role| move |source| (source, role);
        let all: Vec<(Source, Role)> = calibration
            .into_iter()
            .map(assign(Role::Calibration))
            .chain(validation.into_iter().map(assign(Role::Validation)))
            .collect();
        in_parallel(all, |(source, role)| {
            progress.step(format!("reading {}", source.label));
            let loaded = self.pipeline().read(source, role.purpose())?;
            Ok(Assigned { loaded, role })
        })
    }

    /// Calibrates on the recordings that are for it and judges the model on all.
    ///
    /// # Errors
    /// What makes a recording unfit or the fit impossible.
    pub fn fit(
        &self,
        recordings: &[Assigned],
        detail: Detail,
        progress: &Progress,
    ) -> Result<Outcome, Error> {
        let pipeline = self.pipeline();
        for Assigned { loaded, .. } in recordings {
            if loaded.recording.measurement.is_none() {
                let file = loaded.source.file.clone();
                return Err(CalibrationError::NoMeasurement { file }.into());
            }
        }
        SampleRegister::check(recordings.iter().map(|r| (&r.loaded, r.role.name())))?;
        let unit = pipeline.common_unit(recordings.iter().map(|r| &r.loaded))?.unwrap_or_default();
        let prepared = in_parallel(recordings.iter().collect(), |Assigned { loaded, role }| {
            progress.step(format!("preprocessing {}", loaded.source.label));
            pipeline.preprocess(loaded, role.purpose())
        })?;
        progress.step("calibrating");
        let fitted: Vec<NamedRecording> = prepared
            .iter()
            .zip(recordings)
            .filter(|(_, r)| r.role == Role::Calibration)
            .map(|(prepared, _)| prepared.clone())
            .collect();
        let (model, mut calibration) = calibrate_shapes(
            &self.model,
            &fitted,
            &self.scopes,
            unit,
            self.preprocessing.f_dyn_hz,
            &self.options,
            &ShapeOptions::default(),
        )?;
        calibration.warnings.extend(recordings.iter().flat_map(|r| r.loaded.warnings()));
        let calibrated = CalibratedModel {
            model,
            calibration,
            preprocessing: self.preprocessing.clone(),
            instrument: self.instrument.clone(),
            origins: Origins::default(),
        };
        let mut names = PredictionNames::default();
        let named = recordings
            .iter()
            .map(|r| (detail == Detail::RowByRow).then(|| names.name(&r.loaded.source.file)));
        let asked: Vec<_> = prepared.iter().zip(recordings).zip(named).collect();
        let judged = in_parallel(asked, |((prepared, assigned), name)| {
            progress.step(format!("validating on {}", assigned.loaded.source.label));
            self.judge(&calibrated, assigned, prepared, detail, name)
        })?;
        let (recordings, predictions): (Vec<_>, Vec<_>) = judged.into_iter().unzip();
        Ok(Outcome { calibrated, recordings, predictions: predictions.into_iter().flatten().collect() })
    }

    /// How a model does on a recording, and its prediction for the file, of that name, where it is new.
    fn judge(
        &self,
        calibrated: &CalibratedModel,
        Assigned { loaded, role }: &Assigned,
        prepared: &NamedRecording,
        detail: Detail,
        name: Option<(String, bool)>,
    ) -> Result<(RecordingResult, Option<NamedTable>), Error> {
        let here = CalibratedModel {
            calibration: self.acting(&calibrated.calibration, &loaded.source.label),
            ..calibrated.clone()
        };
        let rows = judged_rows(*role, self.preprocessing.trim_rest);
        let pipeline = self.pipeline();
        let predictions = match &name {
            Some((name, true)) => {
                let options = |purpose| pipeline.options(loaded.recording.unit, purpose);
                let is_whole = loaded.source.window_s.is_none();
                let table = if is_whole && options(role.purpose()) == options(Purpose::Prediction) {
                    here.predicted(loaded, prepared)?
                } else {
                    here.predict_file(loaded)?
                };
                Some((name.clone(), table))
            }
            _ => None,
        };
        let comparison = match detail {
            Detail::Errors => Comparison::default(),
            _ => compare(&here.model, &here.calibration, prepared, rows)?,
        };
        let mut notes = loaded.recording.report.notes();
        notes.extend(prepared.data.report.notes());
        let result = RecordingResult {
            label: loaded.source.label.clone(),
            role: *role,
            window_s: loaded.source.window_s,
            validation: validate(&here.model, &here.calibration, prepared, rows)?,
            comparison,
            first_stamp_s: loaded.recording.time_s.first().copied().unwrap_or(0.0),
            notes,
            prediction: name.map(|(name, _)| name),
        };
        Ok((result, predictions))
    }
}

/// Does the same with each of several things, on all processors; of the failures the first in their order counts.
fn in_parallel<T: Send, R: Send>(
    all: Vec<T>,
    one: impl Fn(T) -> Result<R, Error> + Send + Sync,
) -> Result<Vec<R>, Error> {
    let done: Vec<Result<R, Error>> = all.into_par_iter().map(one).collect();
    done.into_iter().collect()
}

impl Job {
    /// A calibration with the coefficients that do not act in a recording set to zero.
    /// (of arm terms that act in other recordings alone).
    pub fn acting(&self, calibration: &Calibration, recording: &str) -> Calibration {
        let mut calibration = calibration.clone();
        let acting = self.scopes.acting(&self.model, recording);
        for (parameter, acts) in calibration.parameters.iter_mut().zip(acting) {
            if !acts {
                parameter.value = 0.0;
            }
        }
        calibration
    }
}

impl CalibratedModel {
    /// How this model reads recordings.
    pub fn pipeline(&self) -> Pipeline<'_> {
        Pipeline {
            joints: RobotJoints::of(&**self.model.rigid_body()),
            preprocessing: &self.preprocessing,
            instrument: &self.instrument,
        }
    }

    /// Refuses what a recording measured in another unit than the model's; one without measurement has none.
    ///
    /// # Errors
    /// [`Error::MixedUnits`].
    pub fn check_unit(&self, loaded: &Loaded) -> Result<(), Error> {
        let ours = self.calibration.unit;
        match self.pipeline().unit(loaded) {
            Some(theirs) if theirs != ours => Err(Error::MixedUnits {
                first: "the calibrated model".into(),
                first_unit: ours,
                other: loaded.source.file.clone(),
                other_unit: theirs,
            }),
            _ => Ok(()),
        }
    }

    /// The prediction for every row of a recording's file, as a table.
    ///
    /// # Errors
    /// What makes the recording unfit.
    pub fn predict_file(&self, loaded: &Loaded) -> Result<Vec<u8>, Error> {
        self.predicted(loaded, &self.pipeline().preprocess(loaded, Purpose::Prediction)?)
    }

    fn predicted(&self, loaded: &Loaded, prepared: &NamedRecording) -> Result<Vec<u8>, Error> {
        let predictions = predict(&self.model, &self.calibration, prepared)?;
        Ok(to_csv(&loaded.stamps_s()?, &predictions, self.calibration.unit))
    }
}
