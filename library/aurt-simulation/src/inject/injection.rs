use aurt_recording::{Preprocessed, Recording, preprocess};

use super::{
    OwnModel, Presence, RealExperiment, Scene, Smoothed, Split, drawing::JointFigures, injectable,
    kinds::Kind, own_model::Rows, strange,
};
use crate::SimulationError;
use crate::Strength;
use crate::case::{CaseRequest, CaseType, Plan};
use crate::fit::mean_square;
use crate::random::Random;

/// A real experiment that effects can be added to.
#[derive(Debug, Clone)]
pub struct Injection {
    pub(super) real: RealExperiment,
    pub(super) model: OwnModel,
    pub(super) recorded: Vec<Recorded>,
    pub(super) figures: Vec<JointFigures>,
    /// Durations of the shortest and the longest recording, s.
    pub(super) shortest_s: f64,
    pub(super) longest_s: f64,
}

/// A recording as it is, and as effects see it.
#[derive(Debug, Clone)]
pub struct Recorded {
    /// What the experiment calls it.
    pub name: String,
    /// The recording.
    pub recording: Recording,
    /// Its motion and load.
    pub scene: Scene,
    pub(super) rows: Rows,
}

impl Injection {
    /// Fits the experiment's structure to the recordings as they are, and differentiates their motion.
    ///
    /// # Errors
    /// Recordings that are not those of the robot, or cannot be preprocessed or differentiated.
    pub fn new(real: RealExperiment) -> Result<Self, SimulationError> {
        real.validate()?;
        let preprocessed: Vec<Preprocessed> =
            real.recordings.iter().map(|r| preprocessed(&r.recording, &real)).collect::<Result<_, _>>()?;
        let model = OwnModel::new(&real, &preprocessed)?;
        let recorded = real
            .recordings
            .iter()
            .zip(&preprocessed)
            .map(|(r, data)| {
                let motion = Smoothed::new(&r.recording, real.options.f_dyn_hz)?;
                Ok(Recorded {
                    name: r.name.clone(),
                    recording: r.recording.clone(),
                    scene: Scene::new(motion, &model)?,
                    rows: model.rows_of(data)?,
                })
            })
            .collect::<Result<Vec<_>, SimulationError>>()?;
        let figures =
            (0..real.chain.joints().len()).map(|j| figures(&recorded, j)).collect::<Result<_, _>>()?;
        let durations = || recorded.iter().map(|r| r.recording.duration_s());
        Ok(Self {
            shortest_s: durations().fold(f64::INFINITY, f64::min),
            longest_s: durations().fold(0.0, f64::max),
            model,
            figures,
            recorded,
            real,
        })
    }

    /// The experiment.
    #[must_use]
    pub const fn real(&self) -> &RealExperiment {
        &self.real
    }

    /// What the experiment's own structure makes of the recordings as they are.
    #[must_use]
    pub const fn model(&self) -> &OwnModel {
        &self.model
    }

    /// The recordings.
    #[must_use]
    pub fn recorded(&self) -> &[Recorded] {
        &self.recorded
    }

    /// All splits of the recordings into roles.
    #[must_use]
    pub fn splits(&self) -> Vec<Split> {
        [Presence::Changed, Presence::All]
            .into_iter()
            .flat_map(|presence| Split::all(self.recorded.len(), presence))
            .collect()
    }

    /// Names of the references: the recordings as they are, in the roles of each split.
    #[must_use]
    pub fn references(&self) -> Vec<String> {
        self.splits().iter().map(|split| split.reference_name(&self.real.name)).collect()
    }

    /// The cases of a plan for these recordings, in an order that tells nothing; robots of the plan do not matter. An
    /// effect that the recordings cannot have (no joint suits it, or their unit does not do) is left out where the plan
    /// asks for all effects.
    ///
    /// # Errors
    /// [`SimulationError::UnknownEffect`], or a pair that does not exist.
    pub fn requests(&self, plan: &Plan, seed: u64) -> Result<Vec<CaseRequest>, SimulationError> {
        let mut random = Random::labelled(seed, "injected plan");
        let mut requests = Vec::new();
        let known = self.possible(&injectable(self.real.unit))?;
        let lists = [
            (&plan.singles, known.clone(), CaseType::Single),
            (&plan.strangers, self.possible(&strange())?, CaseType::Stranger),
        ];
        for (part, all, case_type) in lists {
            let Some(part) = part else { continue };
            let chosen: Vec<String> = if part.effects.is_empty() { all } else { part.effects.clone() };
            for effect in &chosen {
                Kind::named(effect)?;
                for strength in &part.strengths {
                    for _ in 0..part.trials {
                        requests.push(self.request(case_type, std::slice::from_ref(effect), *strength));
                    }
                }
            }
        }
        if let Some(pairs) = &plan.pairs {
            let all = if pairs.effects.is_empty() { known } else { pairs.effects.clone() };
            for _ in 0..pairs.count {
                let mut two = all.clone();
                random.shuffle(&mut two);
                two.truncate(2);
                requests.push(self.request(CaseType::Pair, &two, pairs.strength));
            }
        }
        for _ in 0..plan.nulls.as_ref().map_or(0, |n| n.count) {
            requests.push(self.request(CaseType::Null, &[], Strength::Medium));
        }
        random.shuffle(&mut requests);
        Ok(requests)
    }

    /// Those of some effects that these recordings can have.
    fn possible(&self, effects: &[&str]) -> Result<Vec<String>, SimulationError> {
        let mut possible = Vec::new();
        for effect in effects {
            let kind = Kind::named(effect)?;
            if kind.fits(self.real.unit) && (0..self.figures.len()).any(|j| self.suits(&kind, j)) {
                possible.push((*effect).to_owned());
            }
        }
        Ok(possible)
    }

    fn request(&self, case_type: CaseType, effects: &[String], strength: Strength) -> CaseRequest {
        CaseRequest { robot: self.real.name.clone(), case_type, effects: effects.to_vec(), strength }
    }

    /// A recording's rows with another measurement, `[joint][row]`.
    pub(super) fn filtered(
        &self,
        k: usize,
        measurement: Vec<Vec<f64>>,
    ) -> Result<Vec<Vec<f64>>, SimulationError> {
        let recording = Recording { measurement: Some(measurement), ..self.recorded[k].recording.clone() };
        let data = preprocessed(&recording, &self.real)?;
        let mut rows = vec![Vec::new(); self.figures.len()];
        for segment in &data.segments {
            for (all, series) in rows.iter_mut().zip(segment.measurement.iter().flatten()) {
                all.extend(series);
            }
        }
        Ok(rows)
    }
}

pub(super) fn preprocessed(
    recording: &Recording,
    real: &RealExperiment,
) -> Result<Preprocessed, SimulationError> {
    preprocess(recording, &real.options)
        .map_err(|error| SimulationError::Preprocessing { reason: error.to_string() })
}

fn figures(recorded: &[Recorded], j: usize) -> Result<JointFigures, SimulationError> {
    let all = |of: fn(&Recorded) -> &Vec<Vec<f64>>| -> Vec<f64> {
        recorded.iter().flat_map(|r| of(r)[j].iter().copied()).collect()
    };
    let position = all(|r| &r.scene.motion.position_rad);
    let measured = recorded.iter().flat_map(|r| r.recording.measurement.iter().flat_map(|m| m[j].iter()));
    let inertia = &recorded[0].scene.inertia_column(j)?[j];
    Ok(JointFigures {
        inertia: inertia.iter().sum::<f64>() / inertia.len().max(1) as f64,
        velocity_rad_s: mean_square(&all(|r| &r.scene.motion.velocity_rad_s)).sqrt(),
        range_rad: [
            position.iter().copied().fold(f64::INFINITY, f64::min),
            position.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        ],
        peak: measured.fold(0.0, |peak: f64, y| peak.max(y.abs())),
        load: mean_square(&all(|r| &r.scene.load)).sqrt(),
    })
}
