//! Diagnosing recordings in memory.

use std::path::PathBuf;

use aurt_calibration::{Calibration, Rest, TermScopes};
use aurt_diagnosis::{
    Answer, CommonScale, Improvement, Investigation, Question, QuestionedRecording, RecordingSeries, Role,
    SelectionOptions, Verdict, improvement, investigate, series, write_verdict,
};
use aurt_plugins::Registry;
use aurt_plugins::model::Error as ModelFileError;
use aurt_recording::{
    PreprocessOptions, Preprocessed, Recording, RobotJoints, median_step_s, quiet_f_dyn_hz, suitable_f_dyn_hz,
};
use aurt_traits::{ArmTerm, MeasurementUnit, RobotModel};
use serde_json::Value;

use crate::calibrated_file::CalibratedModel;
use crate::calibrating::Settings;
use crate::data::{Instrument, Loaded, Pipeline, Purpose, Source};
use crate::duplicates::SampleRegister;
use crate::effects::{Effect, Named};
use crate::error::Error;
use crate::fitting::{Assigned, Detail, Job};
use crate::origins::Origins;
use crate::progress::Progress;
use crate::questioned::{Asked, Part};
use crate::role;

/// Joints of the largest arm that is diagnosed. Effects are weighed jointly over all joints, which takes memory with the
/// square of their number and time with its cube.
const MOST_JOINTS: usize = 20;

/// A diagnosis of recordings in memory.
///
/// With recordings of a [target](Self::target), the question is what these show beyond the model; without, what the model
/// lacks in the recordings that it is calibrated on.
///
/// ```no_run
/// use aurt::{diagnosis::SelectionOptions, prelude::*};
///
/// # fn main() -> Result<(), aurt::Error> {
/// let (monday, tuesday) = (Recording::read("monday.csv")?, Recording::read("tuesday.csv")?);
/// let robot = Robot::by_name("ur10e", [0.0, 0.0, -9.81])?;
/// let settings = Settings {
///     preprocessing: PreprocessOptions { f_dyn_hz: 8.0, ..PreprocessOptions::default() },
///     ..Settings::default()
/// };
/// let diagnosis = Diagnoser::new(robot.model().friction(Friction::load_dependent().viscous(2)).build()?)
///     .settings(settings)
///     .selection(SelectionOptions { score: 12.0, ..SelectionOptions::default() })
///     .without([EffectKind::BaseTilt])
///     .calibration(&monday)
///     .target(&tuesday)
///     .diagnose(&Progress::silent())?;
/// for found in diagnosis.effects() {
///     match found.effect {
///         Effect::Payload(load) => println!("{:?} kg on link {}", load.mass_kg, load.link),
///         other => println!("{other:?}"),
///     }
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Diagnoser {
    model: RobotModel,
    given: Option<Calibration>,
    /// The recordings that the given model was calibrated on.
    origins: Origins,
    settings: Settings,
    selection: SelectionOptions,
    without: Vec<String>,
    registry: Option<Registry>,
    name: PathBuf,
    parts: Vec<Part>,
}

impl Diagnoser {
    /// A diagnosis of a model, which is fitted to the recordings.
    pub fn new(model: RobotModel) -> Self {
        Self {
            model,
            given: None,
            origins: Origins::default(),
            settings: Settings::default(),
            selection: SelectionOptions::default(),
            without: Vec::new(),
            registry: None,
            name: "the model".into(),
            parts: Vec::new(),
        }
    }

    /// A diagnosis of a calibrated model as it is, with its own settings: its coefficients are not fitted again.
    pub fn of_given(model: CalibratedModel) -> Self {
        let CalibratedModel { model, calibration, preprocessing, instrument, origins } = model;
        let settings = Settings { preprocessing, instrument, calibration: calibration.options };
        Self { given: Some(calibration), origins, settings, ..Self::new(model) }
    }

    /// How recordings are preprocessed and coefficients found.
    #[must_use]
    pub fn settings(self, settings: Settings) -> Self {
        Self { settings, ..self }
    }

    /// What an effect must bring to be accepted.
    #[must_use]
    pub fn selection(self, selection: SelectionOptions) -> Self {
        Self { selection, ..self }
    }

    /// Effects that are treated as unknown, by their kinds or identifiers.
    #[must_use]
    pub fn without(mut self, effects: impl IntoIterator<Item = impl AsRef<str>>) -> Self {
        self.without.extend(effects.into_iter().map(|effect| effect.as_ref().to_owned()));
        self
    }

    /// The models that the diagnosis may try and name, instead of all linked ones.
    #[must_use]
    pub fn registry(self, registry: Registry) -> Self {
        Self { registry: Some(registry), ..self }
    }

    /// The file of the model, for errors.
    #[must_use]
    pub fn named(self, file: impl Into<PathBuf>) -> Self {
        Self { name: file.into(), ..self }
    }

    /// Adds a recording that the model is calibrated on.
    #[must_use]
    pub fn calibration(self, recording: &Recording) -> Self {
        self.recording(recording, Role::Calibration)
    }

    /// Adds a recording whose mismatch with the model is to be explained.
    #[must_use]
    pub fn target(self, recording: &Recording) -> Self {
        self.recording(recording, Role::Target)
    }

    /// Adds a recording that is held out, for judging what was found.
    #[must_use]
    pub fn validation(self, recording: &Recording) -> Self {
        self.recording(recording, Role::Validation)
    }

    fn recording(self, recording: &Recording, role: Role) -> Self {
        self.part(Part { source: Source::of(recording), recording: recording.clone(), role, simulated: None })
    }

    /// Adds a recording with its file, its window, and what another simulator predicts for it.
    #[must_use]
    pub fn part(mut self, part: Part) -> Self {
        self.parts.push(part);
        self
    }

    /// Finds what is missing.
    ///
    /// # Errors
    /// What makes a recording unfit, and what the diagnosis reports.
    pub fn diagnose(&self, progress: &Progress) -> Result<Diagnosis, Error> {
        self.ask(progress, |question, investigation, _| Diagnosis::of(question, investigation))
    }

    /// Finds what is missing, and fits the model that has it.
    ///
    /// # Errors
    /// As [`Self::diagnose`], and what makes the fit impossible.
    pub fn explain(&self, progress: &Progress) -> Result<Explanation, Error> {
        self.ask(progress, |question, investigation, registry| {
            let diagnosis = Diagnosis::of(question, investigation)?;
            let improvement = improvement(question, investigation);
            progress.step("calibrating the improved model");
            Ok(Explanation {
                diagnosis,
                model: self.improved(&improvement, registry)?,
                added: improvement.terms.iter().map(|(term, scope)| added(term, scope)).collect(),
                notes: improvement.notes,
                series: series(question, investigation),
                diagnosed: question.model.clone(),
                recordings: question.recordings.to_vec(),
            })
        })
    }

    /// Investigates the recordings and hands question and findings to `answer`, for whatever is to be made of them.
    ///
    /// # Errors
    /// What makes a recording unfit, what the diagnosis reports, and the errors of `answer`.
    pub fn ask<T, E: From<Error>>(
        &self,
        progress: &Progress,
        answer: impl FnOnce(&Question<'_>, &Investigation, &Registry) -> Result<T, E>,
    ) -> Result<T, E> {
        let linked;
        let registry = match &self.registry {
            Some(registry) => registry,
            None => {
                linked = Registry::linked().map_err(Error::from)?;
                &linked
            }
        };
        self.check()?;
        let Settings { preprocessing, instrument, calibration } = &self.settings;
        let joints = self.joints();
        let loaded: Vec<Loaded> =
            self.parts.iter().map(|part| part.loaded(&joints)).collect::<Result<_, _>>()?;
        let looked = first_look(&loaded, &joints, preprocessing);
        let f_dyn_hz = match self.selection.f_dyn_hz {
            Some(asked_hz) => quiet_f_dyn_hz(looked.iter(), asked_hz),
            None => suitable_f_dyn_hz(looked.iter()).unwrap_or(preprocessing.f_dyn_hz),
        };
        let preprocessing = &PreprocessOptions { f_dyn_hz, ..preprocessing.clone() };
        let pipeline = Pipeline { joints, preprocessing, instrument };
        SampleRegister::check(
            loaded.iter().zip(&self.parts).map(|(loaded, part)| (loaded, part.role.name())),
        )?;
        self.origins.refuse_copies(self.parts.iter().map(|part| (&part.source, part.role)))?;
        let unit = pipeline.common_unit(&loaded)?.unwrap_or_default();
        if let Some(given) = self.given.as_ref().map(|given| given.unit).filter(|given| *given != unit) {
            return Err(Error::GivenUnit { given, recorded: unit }.into());
        }
        let parts = self.parts.iter().zip(loaded);
        let recordings: Vec<QuestionedRecording> =
            parts.map(|(part, loaded)| part.questioned(loaded, &pipeline)).collect::<Result<_, _>>()?;
        let question = Question {
            model: &self.model,
            frozen: self.given.as_ref(),
            recordings: &recordings,
            unit,
            f_dyn_hz,
            calibration: *calibration,
            selection: self.selection,
            without: &self.without,
            scale: None,
        };
        let scale = CommonScale::of(&question, registry);
        let scaled = scale.as_ref().map(|scale| scale.applied(&question).map_err(Error::from)).transpose()?;
        let recordings = scaled.as_deref().unwrap_or(&recordings);
        let question = Question { recordings, scale: scale.as_ref(), ..question };
        let investigation =
            investigate(&question, registry, |what| progress.step(what)).map_err(Error::from)?;
        answer(&question, &investigation, registry)
    }

    fn joints(&self) -> RobotJoints {
        RobotJoints::of(&**self.model.rigid_body())
    }

    /// Whether the arm is small enough.
    fn check(&self) -> Result<(), Error> {
        let joints = self.model.joints();
        if joints <= MOST_JOINTS {
            return Ok(());
        }
        Err(Error::Unfit {
            path: self.name.clone(),
            reason: format!("the arm has {joints} joints, a diagnosis weighs effects on up to {MOST_JOINTS}"),
            remedy: "diagnose parts of it: a geometry and recordings of the joints of each part".into(),
        })
    }

    /// The model with what was found, fitted as an improved experiment is.
    fn improved(&self, found: &Improvement, registry: &Registry) -> Result<CalibratedModel, Error> {
        let mut terms = self.model.arm_terms().to_vec();
        let mut scopes: Vec<Option<Vec<String>>> = vec![None; terms.len()];
        for (term, scope) in &found.terms {
            terms.push(registry.build_from_json::<dyn ArmTerm>(term).map_err(ModelFileError::Build)?);
            scopes.push(scope.clone());
        }
        let (body, base) = (self.model.rigid_body().clone(), self.model.base().clone());
        let Settings { preprocessing, instrument, mut calibration } = self.settings.clone();
        if found.exclude_rest {
            calibration.rest = Rest::Exclude;
        }
        let job = Job {
            model: RobotModel::new(body, base, self.model.stacks().to_vec(), terms)?,
            preprocessing,
            instrument: corrected(instrument, found),
            options: calibration,
            scopes: TermScopes::new(scopes),
        };
        let fitted = |role: Role| match role {
            Role::Calibration => true,
            Role::Target => found.calibrate_on_target,
            Role::Validation => false,
        };
        let assigned: Vec<Assigned> = self
            .parts
            .iter()
            .filter(|part| fitted(part.role))
            .map(|part| Ok(Assigned { loaded: part.loaded(&self.joints())?, role: role::Role::Calibration }))
            .collect::<Result<_, Error>>()?;
        Ok(job.fit(&assigned, Detail::Errors, &Progress::silent())?.calibrated)
    }
}

/// A first look at recordings that are divided and resampled as asked.
fn first_look(loaded: &[Loaded], joints: &RobotJoints, asked: &PreprocessOptions) -> Vec<Preprocessed> {
    let rate_hz = |one: &Loaded| Some(1.0 / median_step_s(&one.recording.time_s)?);
    let rates = loaded.iter().filter_map(rate_hz).chain(asked.sample_rate_hz);
    let preprocessing = PreprocessOptions {
        sample_rate_hz: asked.sample_rate_hz,
        max_gap_s: asked.max_gap_s,
        ..PreprocessOptions::first_look(rates.fold(f64::INFINITY, f64::min))
    };
    let instrument = Instrument::default();
    let pipeline =
        Pipeline { joints: joints.clone(), preprocessing: &preprocessing, instrument: &instrument };
    let look = |one| Some(pipeline.preprocess_as_read(one, Purpose::Calibration).ok()?.data);
    loaded.iter().filter_map(look).collect()
}

/// The instrument with what was found of it: gains multiply, delays add up.
fn corrected(mut instrument: Instrument, found: &Improvement) -> Instrument {
    let combine = |old: &mut Option<Vec<f64>>, new: &Option<Vec<f64>>, with: fn(f64, f64) -> f64| {
        let Some(new) = new else { return };
        *old = Some(match old.take() {
            Some(old) => old.iter().zip(new).map(|(a, b)| with(*a, *b)).collect(),
            None => new.clone(),
        });
    };
    combine(&mut instrument.gains, &found.gain_factors, |old, factor| old * factor);
    combine(&mut instrument.delay_s, &found.delay_s, |old, more| old + more);
    instrument
}

fn added(term: &Value, scope: &Option<Vec<String>>) -> String {
    match scope {
        None => format!("arm term {term}"),
        Some(names) => format!("arm term {term} in {}", names.join(", ")),
    }
}

/// What a diagnosis found.
#[derive(Debug, Clone)]
pub struct Diagnosis {
    /// The verdict, as `verdict.json` has it.
    pub verdict: Verdict,
    /// What was asked.
    pub asked: Asked,
    /// Unit of the measurement.
    pub unit: MeasurementUnit,
}

impl Diagnosis {
    /// The verdict on a question.
    ///
    /// # Errors
    /// A verdict with a value that is not finite.
    pub fn of(question: &Question<'_>, investigation: &Investigation) -> Result<Self, Error> {
        let verdict = write_verdict(question, investigation).checked()?;
        Ok(Self { verdict, asked: Asked::of(question), unit: question.unit })
    }

    /// The answer: with a target about the change, else about what the model lacks.
    pub const fn answer(&self) -> Answer {
        self.verdict.verdict
    }

    /// Whether something has changed or is missing.
    pub fn is_found(&self) -> bool {
        is_found(&self.verdict)
    }

    /// The effects that are claimed, strongest first.
    pub fn effects(&self) -> Vec<Named<'_>> {
        self.verdict.effects.iter().map(|finding| Named { effect: Effect::of(finding), finding }).collect()
    }
}

/// Whether something has changed or is missing, as a verdict says.
pub fn is_found(verdict: &Verdict) -> bool {
    [Some(verdict.verdict), verdict.structure]
        .into_iter()
        .flatten()
        .any(|answer| answer != Answer::NoMismatch)
}

/// What a diagnosis found, with the model that has it.
#[derive(Debug, Clone)]
pub struct Explanation {
    /// What was found.
    pub diagnosis: Diagnosis,
    /// The model with what was found, calibrated.
    pub model: CalibratedModel,
    /// The arm terms that it has and the diagnosed model does not have.
    pub added: Vec<String>,
    /// What a person should know about it.
    pub notes: Vec<String>,
    /// Residuals of the recordings row by row, in their order.
    pub series: Vec<RecordingSeries>,
    /// The model that was diagnosed.
    pub diagnosed: RobotModel,
    /// The recordings.
    pub recordings: Vec<QuestionedRecording>,
}
