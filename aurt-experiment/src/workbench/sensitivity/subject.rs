use crate::Experiment;
use crate::experiment::place_among;
use aurt::data::Source;
use aurt_calibration::CalibrationOptions;
use aurt_diagnosis::{Question, QuestionedRecording, Role, SelectionOptions, investigate, write_verdict};
use aurt_plugins::Registry;
use aurt_recording::Recording;
use aurt_simulation::inject::{Added, Injection, Presence, Split, applied};
use aurt_traits::{RobotModel, RobotNames};

use super::claims::Claims;
use crate::workbench::diagnosing::selection;
use crate::workbench::failure::Failure;
use crate::workbench::injected;

/// The experiment and recordings that effects are added to.
#[derive(Debug)]
pub struct Subject {
    /// The recordings, and what the experiment's structure leaves of them.
    pub injection: Injection,
    pub split: Split,
    model: RobotModel,
    calibration: CalibrationOptions,
    selection: SelectionOptions,
    /// The recordings as they are, in the order of [`Self::places`].
    recordings: Vec<QuestionedRecording>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    pub number: usize,
    pub role: Role,
    pub affected: bool,
}

impl Subject {
    pub fn names(&self) -> RobotNames<'_> {
        self.model.names()
    }

    pub fn new(experiment: &Experiment) -> Result<Self, Failure> {
        let injection = Injection::new(injected::plain(experiment)?)?;
        let parts = &experiment.recordings;
        // Recordings are numbered as the injection has them.
        let known = parts.each_once();
        let places = |list: &[Source]| list.iter().filter_map(|source| place_among(&known, source)).collect();
        let [calibration, target, validation]: [Vec<usize>; 3] =
            [&parts.calibration, &parts.target, &parts.validation].map(|list| places(list));
        let presence = if target.is_empty() { Presence::All } else { Presence::Changed };
        let mut subject = Self {
            injection,
            split: Split { presence, turn: 0, calibration, target, validation },
            model: experiment.robot_model()?,
            calibration: experiment.calibration,
            selection: selection(experiment)?,
            recordings: Vec::new(),
        };
        subject.recordings = subject.with(&[])?;
        Ok(subject)
    }

    /// The recordings of the question, in its order.
    pub fn places(&self) -> Vec<Place> {
        let changed = self.split.presence == Presence::Changed;
        let parts = [
            (&self.split.calibration, Role::Calibration, !changed),
            (&self.split.target, Role::Target, true),
            (&self.split.validation, Role::Validation, true),
        ];
        let of = |(list, role, affected): (&Vec<usize>, Role, bool)| {
            list.iter().map(move |number| Place { number: *number, role, affected }).collect::<Vec<_>>()
        };
        parts.into_iter().flat_map(of).collect()
    }

    /// Whether an effect is added to a recording: what is local in time is in the first target alone.
    pub fn has(&self, place: Place, effect: &Added) -> bool {
        place.affected && (!effect.is_local() || self.split.target.first() == Some(&place.number))
    }

    pub fn altered(&self, place: Place, effects: &[&Added]) -> Result<Recording, Failure> {
        let recorded = &self.injection.recorded()[place.number];
        let here: Vec<&Added> = effects.iter().copied().filter(|e| self.has(place, e)).collect();
        Ok(applied(&here, &recorded.scene, &recorded.recording)?)
    }

    fn with(&self, effects: &[&Added]) -> Result<Vec<QuestionedRecording>, Failure> {
        let options = &self.injection.real().options;
        let one = |place: Place| {
            let raw = self.altered(place, effects)?;
            let name = self.injection.recorded()[place.number].name.clone();
            Ok(QuestionedRecording::new(place.role, name, raw, options.clone())?)
        };
        self.places().into_iter().map(one).collect()
    }

    pub fn question(&self) -> Question<'_> {
        self.asked(&self.recordings)
    }

    fn asked<'a>(&'a self, recordings: &'a [QuestionedRecording]) -> Question<'a> {
        let real = self.injection.real();
        Question {
            model: &self.model,
            frozen: None,
            recordings,
            unit: real.unit,
            f_dyn_hz: real.options.f_dyn_hz,
            calibration: self.calibration,
            selection: self.selection,
            without: &[],
            scale: None,
        }
    }

    /// What a whole diagnosis claims of the recordings with effects.
    pub fn diagnosed(&self, effects: &[&Added], registry: &Registry) -> Result<Claims, Failure> {
        let recordings = self.with(effects)?;
        let question = self.asked(&recordings);
        let investigation = investigate(&question, registry, |_| {})?;
        Ok(Claims::of(&write_verdict(&question, &investigation)))
    }
}
