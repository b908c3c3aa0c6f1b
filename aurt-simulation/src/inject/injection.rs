use aurt_recording::{Preprocessed, Recording};

use super::gram::mean_square;
use super::own_model::{OwnModel, Rows};
use super::real::RealExperiment;
use super::scene::Scene;
use super::smoothed::Smoothed;
use crate::error::SimulationError;
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
    pub recording: Recording,
    /// Its motion and load.
    pub scene: Scene,
    /// Its rows after the usual preprocessing.
    pub rows: Rows,
}

impl Injection {
    /// Fits the experiment's structure to the recordings as they are, and differentiates their motion.
    ///
    /// # Errors
    /// Recordings that are not those of the robot, or cannot be preprocessed or differentiated.
    pub fn new(real: RealExperiment) -> Result<Self, SimulationError> {
        real.validate()?;
        let preprocessed: Vec<Preprocessed> =
            real.recordings.iter().map(|r| real.preprocessed(&r.recording)).collect::<Result<_, _>>()?;
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
        let figures = (0..real.bodies.joints()).map(|j| figures(&recorded, j)).collect::<Result<_, _>>()?;
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

    pub const fn real(&self) -> &RealExperiment {
        &self.real
    }

    /// What the experiment's own structure makes of the recordings as they are.
    pub const fn model(&self) -> &OwnModel {
        &self.model
    }

    pub fn joints(&self) -> usize {
        self.figures.len()
    }

    pub fn recorded(&self) -> &[Recorded] {
        &self.recorded
    }

    /// A recording's rows with another measurement, `[joint][row]`.
    pub(super) fn filtered(
        &self,
        k: usize,
        measurement: Vec<Vec<f64>>,
    ) -> Result<Vec<Vec<f64>>, SimulationError> {
        let recording = Recording { measurement: Some(measurement), ..self.recorded[k].recording.clone() };
        let data = self.real.preprocessed(&recording)?;
        let mut rows = vec![Vec::new(); self.figures.len()];
        for segment in &data.segments {
            for (all, series) in rows.iter_mut().zip(segment.measurement.iter().flatten()) {
                all.extend(series);
            }
        }
        Ok(rows)
    }
}

/// A joint's figures over all recordings, from which effects are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct JointFigures {
    /// Root mean square of q̇, rad/s.
    pub velocity_rad_s: f64,
    /// Smallest and largest q, rad.
    pub range_rad: [f64; 2],
    /// Largest measurement.
    pub peak: f64,
    /// Root mean square of the rigid bodies' torque.
    pub load: f64,
    /// Mean of the joint's own inertia, as fitted, kg m².
    pub inertia: f64,
}

impl JointFigures {
    pub fn width_rad(&self) -> f64 {
        self.range_rad[1] - self.range_rad[0]
    }

    pub fn inside_rad(&self, random: &mut Random) -> f64 {
        self.range_rad[0] + self.width_rad() * random.unit()
    }
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
