use aurt_calibration::{CalibrationOptions, NamedRecording};
use aurt_diagnosis::{
    Answer, Finding, Question, QuestionedRecording, Role, SelectionOptions, investigate, write_verdict,
};
use aurt_experiment::{Experiment, Registry, experiment::RecordingSource};
use aurt_recording::{Recording, preprocess};
use aurt_simulation::inject::{Added, Injection, Presence, Split};
use aurt_traits::RobotModel;

use crate::{failure::Failure, fitting::calibration_options, injected};

/// The experiment and recordings that effects are added to.
#[derive(Debug)]
pub struct Subject<'a> {
    /// The recordings, and what the experiment's structure leaves of them.
    pub injection: Injection,
    /// What each recording is for.
    pub split: Split,
    model: RobotModel,
    calibration: CalibrationOptions,
    registry: &'a Registry,
}

/// What a diagnosis claims.
#[derive(Debug, Clone, Default)]
pub struct Claims {
    /// Whether its word names something.
    names: bool,
    /// Whether its word says that something has no name.
    unexplained: bool,
    /// Effect and joint; no joint for effects of the whole arm.
    claims: Vec<(String, Vec<usize>)>,
}

impl<'a> Subject<'a> {
    /// The subject of an experiment.
    ///
    /// # Errors
    /// As [`injected::plain`]; models that do not fit the robot.
    pub fn new(experiment: &Experiment, registry: &'a Registry) -> Result<Self, Failure> {
        let injection = Injection::new(injected::plain(experiment)?)?;
        let parts = &experiment.recordings;
        let all: Vec<&RecordingSource> =
            parts.calibration.iter().chain(&parts.target).chain(&parts.validation).collect();
        // Recordings are numbered as the injection has them: in this order, each once.
        let same = |a: &RecordingSource, b: &RecordingSource| a.file == b.file && a.window_s == b.window_s;
        let mut known: Vec<&RecordingSource> = Vec::new();
        for source in all {
            if !known.iter().any(|s| same(s, source)) {
                known.push(source);
            }
        }
        let places = |list: &[RecordingSource]| -> Vec<usize> {
            list.iter().filter_map(|source| known.iter().position(|s| same(s, source))).collect()
        };
        let (calibration, target) = (places(&parts.calibration), places(&parts.target));
        let validation = places(&parts.validation);
        let presence = if target.is_empty() { Presence::All } else { Presence::Changed };
        Ok(Self {
            injection,
            split: Split { presence, turn: 0, calibration, target, validation },
            model: experiment.robot_model()?,
            calibration: calibration_options(experiment),
            registry,
        })
    }

    /// What a diagnosis claims of the recordings with these effects.
    ///
    /// # Errors
    /// What the diagnosis reports.
    pub fn claims(&self, effects: &[&Added]) -> Result<Claims, Failure> {
        let real = self.injection.real();
        let changed = self.split.presence == Presence::Changed;
        let parts = [
            (&self.split.calibration, Role::Calibration, !changed),
            (&self.split.target, Role::Target, true),
            (&self.split.validation, Role::Validation, true),
        ];
        let mut recordings = Vec::new();
        for (list, role, affected) in parts {
            for k in list {
                let recorded = &self.injection.recorded()[*k];
                let here = effects
                    .iter()
                    .filter(|e| affected && (!e.is_local() || self.split.target.first() == Some(k)));
                let raw: Recording = here
                    .clone()
                    .try_fold(recorded.recording.clone(), |r, e| e.applied(&recorded.scene, &r))?;
                recordings.push(QuestionedRecording {
                    role,
                    data: NamedRecording {
                        name: recorded.name.clone(),
                        data: preprocess(&raw, &real.options)?,
                    },
                    raw,
                    options: real.options.clone(),
                    simulated: None,
                    spoilt: None,
                });
            }
        }
        let question = Question {
            model: &self.model,
            frozen: None,
            recordings: &recordings,
            unit: real.unit,
            f_dyn_hz: real.options.f_dyn_hz,
            calibration: self.calibration,
            selection: SelectionOptions::default(),
            without: &[],
        };
        let investigation = investigate(&question, self.registry, |_| {})?;
        let verdict = write_verdict(&question, &investigation);
        let claim = |f: &Finding| (f.effect.clone(), f.joints.clone());
        Ok(Claims {
            names: matches!(verdict.verdict, Answer::Named | Answer::Ambiguous),
            unexplained: verdict.verdict == Answer::Unexplained,
            claims: verdict.effects.iter().map(claim).collect(),
        })
    }
}

impl Claims {
    /// Whether an effect is claimed, on a joint if one is given, whatever the verdict's word.
    pub fn lists(&self, effect: &str, joint: Option<usize>) -> bool {
        self.claims.iter().any(|(name, joints)| name == effect && joint.is_none_or(|j| joints.contains(&j)))
    }

    /// Whether an effect is named.
    pub fn names(&self, effect: &str, joint: Option<usize>) -> bool {
        self.names && self.lists(effect, joint)
    }

    /// Whether more is claimed than of the recordings as they are: at the joint, or, of the arm, anywhere.
    pub fn exceeds(&self, reference: &Self, joint: Option<usize>) -> bool {
        let new = |(name, joints): &(String, Vec<usize>)| {
            let here: Vec<usize> = joints.iter().copied().filter(|j| joint.is_none_or(|k| k == *j)).collect();
            (joint.is_none() && joints.is_empty() && !reference.lists(name, None))
                || here.iter().any(|j| !reference.lists(name, Some(*j)))
        };
        self.unexplained && !reference.unexplained || self.claims.iter().any(new)
    }
}
