//! Diagnosing recordings in memory.

use aurt_calibration::TermScopes;
use aurt_diagnosis::{
    Improvement, Investigation, Question, QuestionedRecording, Role, SelectionOptions, Verdict, improvement,
    investigate, series, write_verdict,
};
use aurt_experiment::Registry;
use aurt_recording::{Recording, RobotJoints};
use aurt_report::Page;
use aurt_traits::{ArmTerm, MeasurementUnit, RobotModel};
use serde_json::{Value, json};

use crate::{
    calibrated_file::CalibratedModel,
    calibrating::Settings,
    data::{Instrument, Loaded, Pipeline},
    diagnosing::{check_joints, is_found, notes_of, questioned_recordings},
    failure::Failure,
    fitting::{Assigned, Detail, Job},
    progress::Progress,
    rendering::{joints::with_names, style::Style},
    reports::diagnosis::{Diagnosed, arm, words::Asked},
    results::{metrics, verdict::Shown},
};

/// A diagnosis of recordings in memory.
///
/// With recordings of a [target](Self::target), the question is what these show beyond the model; without, what the model
/// lacks in the recordings that it is calibrated on.
#[derive(Debug, Clone)]
pub struct Diagnoser {
    model: RobotModel,
    settings: Settings,
    recordings: Vec<(Recording, Role)>,
}

impl Diagnoser {
    /// A diagnosis of a model, which is fitted to the recordings.
    #[must_use]
    pub fn new(model: RobotModel) -> Self {
        Self { model, settings: Settings::default(), recordings: Vec::new() }
    }

    /// How recordings are preprocessed and coefficients found.
    #[must_use]
    pub fn settings(self, settings: Settings) -> Self {
        Self { settings, ..self }
    }

    fn recording(mut self, recording: &Recording, role: Role) -> Self {
        self.recordings.push((recording.clone(), role));
        self
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

    /// Finds what is missing.
    ///
    /// # Errors
    /// What makes a recording unfit, and what the diagnosis reports.
    pub fn diagnose(&self) -> Result<Verdict, Failure> {
        self.ask(&Progress::silent(), |question, investigation, _| {
            Ok(write_verdict(question, investigation).checked()?)
        })
    }

    /// Finds what is missing, and fits the model that has it; `progress` is told what is being done.
    ///
    /// # Errors
    /// As [`Self::diagnose`], and what makes the fit impossible.
    pub fn explain(&self, progress: &Progress) -> Result<Explanation, Failure> {
        self.ask(progress, |question, investigation, registry| {
            let verdict = write_verdict(question, investigation).checked()?;
            let improvement = improvement(question, investigation);
            progress.step("calibrating the improved model");
            let model = self.improved(&improvement, registry)?;
            let asked = Asked::of(question);
            let document = with_names(json!(verdict), self.model.rigid_body().joint_names());
            let held_out = verdict.held_out.recordings.clone();
            let added: Vec<String> =
                improvement.terms.iter().map(|(term, scope)| added(term, scope)).collect();
            let report = Diagnosed {
                verdict: &verdict,
                asked,
                held_out: &held_out,
                series: &series(question, investigation),
                unit: question.unit,
                improved: (&model.model, &model.calibration),
                added: added.clone(),
                notes: &improvement.notes,
                recording_notes: question.recordings.iter().map(notes_of).collect(),
                document: &document,
                arm_m: arm::points_m(question.model, question.recordings),
            }
            .page();
            let unit = question.unit;
            Ok(Explanation { verdict, document, asked, unit, added, model, notes: improvement.notes, report })
        })
    }

    /// Investigates the recordings and hands over what was asked and found.
    fn ask<T>(
        &self,
        progress: &Progress,
        answer: impl FnOnce(&Question<'_>, &Investigation, &Registry) -> Result<T, Failure>,
    ) -> Result<T, Failure> {
        let registry = Registry::linked()?;
        let Settings { preprocessing, instrument, calibration } = &self.settings;
        check_joints("the model".as_ref(), self.model.joints())?;
        let joints = RobotJoints::of(&**self.model.rigid_body());
        let pipeline = Pipeline { joints, preprocessing, instrument };
        let loaded = self.recordings.iter().map(|(r, role)| Ok((Loaded::of(r, &pipeline.joints)?, *role)));
        let loaded: Vec<(Loaded, Role)> = loaded.collect::<Result<_, Failure>>()?;
        let unit = pipeline.common_unit(loaded.iter().map(|(l, _)| l))?.unwrap_or_default();
        let recordings: Vec<QuestionedRecording> =
            questioned_recordings(loaded, &pipeline, &mut std::iter::empty(), self.questioned())?;
        let question = Question {
            model: &self.model,
            frozen: None,
            recordings: &recordings,
            unit,
            f_dyn_hz: preprocessing.f_dyn_hz,
            calibration: *calibration,
            selection: SelectionOptions::default(),
            without: &[],
        };
        let investigation = investigate(&question, &registry, |what| progress.step(what))?;
        answer(&question, &investigation, &registry)
    }

    /// The part whose mismatch is the question.
    fn questioned(&self) -> Role {
        let has_target = self.recordings.iter().any(|(_, role)| *role == Role::Target);
        if has_target { Role::Target } else { Role::Calibration }
    }

    /// The model with what was found, fitted as an improved experiment is.
    fn improved(&self, found: &Improvement, registry: &Registry) -> Result<CalibratedModel, Failure> {
        let mut terms = self.model.arm_terms().to_vec();
        let mut scopes: Vec<Option<Vec<String>>> = vec![None; terms.len()];
        for (term, scope) in &found.terms {
            terms.push(registry.build_from_json::<dyn ArmTerm>(term).map_err(Failure::Build)?);
            scopes.push(scope.clone());
        }
        let (body, base) = (self.model.rigid_body().clone(), self.model.base().clone());
        let model =
            RobotModel::new(body, base, self.model.stacks().to_vec(), terms).map_err(Failure::Models)?;
        let Settings { preprocessing, instrument, calibration } = self.settings.clone();
        let job = Job {
            model,
            preprocessing,
            instrument: corrected(instrument, found),
            options: calibration,
            scopes: TermScopes::new(scopes),
        };
        let fitted = |role: Role| match role {
            Role::Calibration => true,
            Role::Target => found.calibrate_on_target || self.questioned() == Role::Target,
            Role::Validation => false,
        };
        let assigned: Vec<Assigned> = self
            .recordings
            .iter()
            .filter(|(_, role)| fitted(*role))
            .map(|(r, _)| {
                let loaded = Loaded::of(r, &job.pipeline().joints)?;
                Ok(Assigned { loaded, role: metrics::Role::Calibration })
            })
            .collect::<Result<_, Failure>>()?;
        Ok(job.fit(&assigned, Detail::Errors, &Progress::silent())?.calibrated)
    }
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

/// An added term in a line.
fn added(term: &Value, scope: &Option<Vec<String>>) -> String {
    match scope {
        None => format!("arm term {term}"),
        Some(names) => format!("arm term {term} in {}", names.join(", ")),
    }
}

/// What a diagnosis of recordings in memory found.
#[derive(Debug, Clone)]
pub struct Explanation {
    /// The verdict.
    pub verdict: Verdict,
    /// The same as `verdict.json` has it.
    pub document: Value,
    /// What was asked.
    pub asked: Asked,
    /// Unit of the measurement.
    pub unit: MeasurementUnit,
    /// The arm terms that the improved model has and the diagnosed one has not.
    pub added: Vec<String>,
    /// The model with what was found, calibrated.
    pub model: CalibratedModel,
    /// What a person should know about it.
    pub notes: Vec<String>,
    /// The report.
    pub report: Page,
}

impl Explanation {
    /// Whether something has changed or is missing.
    #[must_use]
    pub fn is_found(&self) -> bool {
        is_found(&self.verdict)
    }

    /// The verdict in a dozen lines.
    #[must_use]
    pub fn to_text(&self, style: Style) -> String {
        let Self { verdict, asked, unit, .. } = self;
        let (held_out, warnings) = (&verdict.held_out.recordings, &self.model.calibration.warnings);
        Shown { verdict, asked: *asked, unit: unit.symbol(), held_out, warnings }.to_text(style)
    }
}
