//! What is tried: a robot's geometry under gravity with recordings of it, small enough to be fitted many times.

use std::any::Any;
use std::sync::{Arc, OnceLock};

use crate::Experiment;
use crate::experiment::{Geometry, Robot};
use crate::workbench::experiments::windowed;
use crate::workbench::failure::Failure;
use aurt::Role;
use aurt::data::{Instrument, Loaded, Pipeline, Preprocessing, Purpose, Source};
use aurt::fitting::Assigned;
use aurt_calibration::{CalibrationOptions, NamedRecording, Rest, SLIDE_LEVER_M, TermScopes};
use aurt_diagnosis::RecordingFaults;
use aurt_rbd::{CoupledChain, Coupling, Joint, MdhTable, RobotDescription, SerialChain};
use aurt_recording::{Recording, median_step_s, preprocess};
use aurt_traits::{ArmTerm, MeasurementUnit, RigidBodyRegressor, RobotModel};

use super::mistake::Mistake;

/// Samples of all recordings of one role that a trial looks at, and of each recording that a test does.
const MOST_SAMPLES: usize = 1800;
/// Samples per period of f_dyn that thinned recordings keep: the position filter at 5 f_dyn needs more than ten.
const SAMPLES_PER_PERIOD: f64 = 12.0;
/// Share of the motion of a recording that is fitted where none is held out; the rest judges.
const FITTED_SHARE: f64 = 0.7;
/// Stretches of a recording that are predicted from each other.
const STRETCHES: usize = 3;
/// Of the speed of a recording, what counts as rest.
pub(super) const SLOW_SHARE: f64 = 0.1;
const F_DYN_SHARE_OF_RATE: f64 = 0.06;
const HIGHEST_F_DYN_HZ: f64 = 5.0;

/// A robot with recordings of it, as a user has set them up.
#[derive(Debug, Clone)]
pub struct Subject {
    pub joints: Vec<Joint>,
    /// How each of them moves; empty where none follows another.
    pub couplings: Vec<Coupling>,
    pub table: Option<MdhTable>,
    pub name: Option<String>,
    /// Gravitational acceleration in the base frame.
    pub gravity_m_s2: [f64; 3],
    pub recordings: Vec<Assigned>,
    pub preprocessing: Preprocessing,
    pub instrument: Instrument,
    /// What the model has beside rigid bodies and friction.
    pub arm_terms: Vec<Box<dyn ArmTerm>>,
    pub scopes: TermScopes,
}

impl Subject {
    /// A robot of which no experiment says anything.
    fn new(
        (joints, couplings): (Vec<Joint>, Vec<Coupling>),
        gravity_m_s2: [f64; 3],
        recordings: Vec<Assigned>,
        f_dyn_hz: f64,
    ) -> Self {
        Self {
            joints,
            couplings,
            table: None,
            name: None,
            gravity_m_s2,
            recordings,
            preprocessing: Preprocessing::new(f_dyn_hz),
            instrument: Instrument::default(),
            arm_terms: Vec::new(),
            scopes: TermScopes::everywhere(),
        }
    }

    pub fn of_table(
        table: &MdhTable,
        gravity_m_s2: [f64; 3],
        recordings: Vec<Assigned>,
        f_dyn_hz: f64,
    ) -> Self {
        let subject = Self::new((table.joints(), Vec::new()), gravity_m_s2, recordings, f_dyn_hz);
        Self { table: Some(table.clone()), ..subject }
    }

    /// A robot given by its rigid bodies; `None` if these are no chain.
    pub fn of_bodies(
        bodies: &dyn RigidBodyRegressor,
        recordings: Vec<Assigned>,
        f_dyn_hz: f64,
    ) -> Option<Self> {
        Some(Self::new(chain_of(bodies)?, bodies.gravity_m_s2(), recordings, f_dyn_hz))
    }

    pub fn of_experiment(experiment: &Experiment, recordings: Vec<Assigned>) -> Result<Self, Failure> {
        let Robot { geometry, gravity_m_s2, .. } = &experiment.robot;
        let chain = match chain_of(&*experiment.robot.rigid_body()?) {
            Some(chain) => chain,
            None => (geometry.chain(*gravity_m_s2)?.joints().to_vec(), Vec::new()),
        };
        let (table, name) = match geometry {
            Geometry::Mdh { table, .. } => (Some(table.clone()), None),
            Geometry::Known(robot) => (None, Some(robot.name.clone())),
            Geometry::Urdf { .. } => (None, None),
        };
        Ok(Self {
            table,
            name,
            preprocessing: experiment.preprocess.clone(),
            instrument: experiment.instrument.clone(),
            arm_terms: experiment.arm_terms.clone(),
            scopes: TermScopes::new(experiment.arm_term_recordings.clone()),
            ..Self::new(chain, *gravity_m_s2, recordings, experiment.preprocess.f_dyn_hz)
        })
    }

    /// Whether other robots can be compared with this one. By currents whose torque constants are not known they cannot:
    /// parameters that joints share are wrong there by the ratios of the constants, which a wrong robot can make up for better
    /// than the right one.
    pub(super) fn compares_robots(&self) -> bool {
        let is_current =
            |r: &Assigned| self.instrument.unit(r.loaded.recording.unit) == MeasurementUnit::Ampere;
        !self.recordings.iter().any(is_current)
    }

    pub(super) fn joint_names(&self) -> &[String] {
        self.recordings.first().map_or(&[], |assigned| assigned.loaded.recording.joints.names())
    }

    pub(super) fn moving_joints(&self) -> usize {
        moving_joints(&self.joints, &self.couplings)
    }
}

/// The joints of a chain, and how they move.
fn chain_of(bodies: &dyn RigidBodyRegressor) -> Option<(Vec<Joint>, Vec<Coupling>)> {
    let any: &dyn Any = bodies;
    if let Some(coupled) = any.downcast_ref::<CoupledChain>() {
        return Some((coupled.chain().joints().to_vec(), coupled.couplings().to_vec()));
    }
    Some((any.downcast_ref::<SerialChain>()?.joints().to_vec(), Vec::new()))
}

fn moving_joints(joints: &[Joint], couplings: &[Coupling]) -> usize {
    couplings.iter().map(|c| c.coordinate + 1).max().unwrap_or(joints.len())
}

/// Reads what an experiment calibrates and validates on.
pub fn recordings_of(experiment: &Experiment) -> Result<Vec<Assigned>, Failure> {
    let joints = experiment.robot.robot_joints();
    let read = |(source, role): (&Source, Role)| {
        let loaded = Loaded::read(source.clone(), Some(&joints), Purpose::Calibration)?;
        Ok(Assigned { loaded, role })
    };
    experiment.recordings.fitted_and_held_out().map(read).collect()
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// The beginnings, as many samples of all recordings of a role as of one: for many trials.
    Brief,
    /// The beginning of each recording: for tests.
    Beginnings,
    Whole,
}

/// What one trial fits and judges.
#[derive(Debug, Clone)]
pub struct Setup {
    pub joints: Vec<Joint>,
    /// How each of them moves; empty where none follows another.
    pub couplings: Vec<Coupling>,
    /// Gravitational acceleration in the base frame.
    pub gravity_m_s2: [f64; 3],
    pub parts: Vec<Part>,
    pub undone: Vec<Mistake>,
    /// The model of these links and joints, once it was asked for; nothing in it if there is none.
    pub model: OnceLock<Option<Arc<RobotModel>>>,
}

/// A thinned stretch of a recording.
#[derive(Debug, Clone)]
pub struct Part {
    /// The recording that it is from, by its place among the subject's.
    pub file: usize,
    pub label: String,
    /// Whether it is fitted; otherwise it judges.
    pub fitted: bool,
    pub recording: Arc<Recording>,
    pub options: Arc<Preprocessing>,
    /// Up to this |q̇_j| a row does not count for joint j, rad/s ([`CalibrationOptions::rest_velocity`]): what holds a joint at rest knows no sign. A share of the speed in
    /// the recording as it is, so that the same rows count whatever the units of angles and stamps.
    pub slow_rad_s: f64,
    /// The first stamp of the recording, s.
    pub origin_s: f64,
    prepared: OnceLock<Option<Arc<NamedRecording>>>,
}

impl Part {
    /// Options of the fit of its rows.
    pub fn rest_options(&self) -> CalibrationOptions {
        CalibrationOptions {
            rest: Rest::Exclude,
            rest_velocity_rad_s: self.slow_rad_s,
            ..CalibrationOptions::default()
        }
    }

    /// The part on its grid; nothing if its samples allow no filter.
    pub fn prepared(&self) -> Option<Arc<NamedRecording>> {
        self.prepared
            .get_or_init(|| {
                let data = preprocess(&self.recording, &self.options).ok()?;
                Some(Arc::new(NamedRecording { name: self.label.clone(), data }))
            })
            .clone()
    }

    /// The same with other samples or another way of preprocessing.
    pub fn with(&self, recording: Arc<Recording>, options: Arc<Preprocessing>) -> Self {
        Self {
            file: self.file,
            label: self.label.clone(),
            fitted: self.fitted,
            recording,
            options,
            slow_rad_s: self.slow_rad_s,
            origin_s: self.origin_s,
            prepared: OnceLock::new(),
        }
    }
}

impl Setup {
    /// The setup of a subject, thinned: held-out recordings judge; where there are none, the last part of each motion does.
    pub fn of(subject: &Subject, extent: Extent) -> Result<Self, Failure> {
        let measured = |r: &&Assigned| r.loaded.recording.measurement.is_some();
        let is_held_out = subject.recordings.iter().filter(measured).any(|r| r.role == Role::Validation);
        let pipeline = Pipeline {
            joints: subject.moving_joints().into(),
            preprocessing: &subject.preprocessing,
            instrument: &subject.instrument,
        };
        let counted =
            |role| subject.recordings.iter().filter(measured).filter(move |r| r.role == role).count();
        let slides = |joint| Coupling::slides(joint, &subject.joints, &subject.couplings);
        let mut parts = Vec::new();
        for (file, assigned) in subject.recordings.iter().enumerate().filter(|(_, r)| measured(r)) {
            let whole = window(&assigned.loaded)?;
            let options = pipeline.options(whole.unit, Purpose::Calibration);
            let most = match extent {
                Extent::Brief => MOST_SAMPLES / counted(assigned.role).max(1),
                Extent::Beginnings => MOST_SAMPLES,
                Extent::Whole => usize::MAX,
            };
            let thin = Thin::new(&whole, &options, most);
            let recording = thin.recording(&whole);
            let options = thin.options(&options);
            let [cut_to_motion, whole_of] = [true, false].map(|trim_rest| {
                Arc::new(Preprocessing { trim_rest: trim_rest && options.trim_rest, ..options.clone() })
            });
            let label = assigned.loaded.source.label.clone();
            let origin_s = assigned.loaded.recording.time_s.first().copied().unwrap_or_default();
            let speeds = speeds_rad_s(&recording, slides);
            let squares: f64 = speeds.iter().flatten().map(|v| v * v).sum();
            let count = speeds.iter().map(Vec::len).sum::<usize>().max(1);
            let slow_rad_s = SLOW_SHARE * (squares / count as f64).sqrt();
            let part = |range: std::ops::Range<usize>, fitted| Part {
                file,
                label: label.clone(),
                fitted,
                recording: Arc::new(recording.rows(range)),
                options: if fitted { cut_to_motion.clone() } else { whole_of.clone() },
                slow_rad_s,
                origin_s,
                prepared: OnceLock::new(),
            };
            let samples = recording.samples();
            if is_held_out {
                parts.push(part(0..samples, assigned.role == Role::Calibration));
            } else {
                let moves = |k: &usize| speeds.iter().any(|v| v[*k].abs() > slow_rad_s);
                let moving: Vec<usize> = (0..samples.saturating_sub(1)).filter(moves).collect();
                let last = (moving.len() as f64 * FITTED_SHARE) as usize;
                let fitted = moving.get(last).map_or(samples, |k| k + 1);
                parts.extend([part(0..fitted, true), part(fitted..samples, false)]);
            }
        }
        Ok(Self {
            joints: subject.joints.clone(),
            couplings: subject.couplings.clone(),
            gravity_m_s2: subject.gravity_m_s2,
            parts,
            undone: Vec::new(),
            model: OnceLock::new(),
        })
    }

    pub fn moving_joints(&self) -> usize {
        moving_joints(&self.joints, &self.couplings)
    }

    /// Setups of a recording alone, of which each stretch in turn judges and the others are fitted.
    pub fn stretches(&self, file: usize) -> Vec<Self> {
        let parts: Vec<&Part> = self.parts.iter().filter(|p| p.file == file).collect();
        let Some((first, others)) = parts.split_first() else { return Vec::new() };
        let mut whole = (*first.recording).clone();
        others.iter().for_each(|part| whole.extend((*part.recording).clone()));
        let options = &parts[parts.len() - 1].options;
        let bound = |k: usize| k * whole.samples() / STRETCHES;
        let stretches: Vec<Arc<Recording>> =
            (0..STRETCHES).map(|k| Arc::new(whole.rows(bound(k)..bound(k + 1)))).collect();
        let judged_by = |judge: usize| {
            let part = |(k, stretch): (usize, &Arc<Recording>)| Part {
                fitted: k != judge,
                ..first.with(stretch.clone(), options.clone())
            };
            let parts = stretches.iter().enumerate().map(part).collect();
            Self { parts, ..self.clone() }
        };
        (0..STRETCHES).map(judged_by).collect()
    }

    /// Number of recordings that are looked at.
    pub fn files(&self) -> Vec<usize> {
        let mut files: Vec<usize> = self.parts.iter().map(|p| p.file).collect();
        files.dedup();
        files
    }
}

/// What is used of a recording, without rows that are held, repeated or corrupt: a clock or a delay makes up for these.
fn window(loaded: &Loaded) -> Result<Recording, Failure> {
    let recording = windowed(loaded)?;
    Ok(RecordingFaults::find("", &recording).repaired(&recording).unwrap_or(recording))
}

/// From each sample to the next, per joint, rad/s, of joints that slide over [`SLIDE_LEVER_M`]; 0 where the stamps tell none.
fn speeds_rad_s(recording: &Recording, slides: impl Fn(usize) -> bool) -> Vec<Vec<f64>> {
    let of = |(joint, q): (usize, &Vec<f64>)| {
        let lever = if slides(joint) { SLIDE_LEVER_M } else { 1.0 };
        let speed = |(q, t): (&[f64], &[f64])| {
            let speed = (q[1] - q[0]) / (t[1] - t[0]) / lever;
            if speed.is_finite() { speed } else { 0.0 }
        };
        q.windows(2).zip(recording.time_s.windows(2)).map(speed).collect()
    };
    recording.position_rad.iter().enumerate().map(of).collect()
}

struct Thin {
    together: usize,
    most: usize,
    f_dyn_hz: f64,
}

impl Thin {
    fn new(recording: &Recording, options: &Preprocessing, most: usize) -> Self {
        // Rows that are missing one by one lower the rate, gaps do not.
        let longest_s = 3.0 * median_period_s(&recording.time_s);
        let distances = recording.time_s.windows(2).map(|w| w[1] - w[0]).filter(|d| *d <= longest_s);
        let (sum_s, count) = distances.fold((0.0, 0.0), |(sum, count), d| (sum + d, count + 1.0));
        let rate_hz = count / f64::max(sum_s, f64::MIN_POSITIVE);
        let f_dyn_hz = options.f_dyn_hz.min(F_DYN_SHARE_OF_RATE * rate_hz).min(HIGHEST_F_DYN_HZ);
        let together = ((rate_hz / (SAMPLES_PER_PERIOD * f_dyn_hz)).floor() as usize).max(1);
        Self { together, most, f_dyn_hz }
    }

    /// Means over neighbouring samples, which keep noise from folding back.
    fn recording(&self, recording: &Recording) -> Recording {
        let mean = |series: &Vec<f64>| -> Vec<f64> {
            let means = series.chunks_exact(self.together).map(|c| c.iter().sum::<f64>() / c.len() as f64);
            means.take(self.most).collect()
        };
        let family = |family: &Vec<Vec<f64>>| family.iter().map(mean).collect();
        Recording {
            file: recording.file.clone(),
            time_s: mean(&recording.time_s),
            position_rad: family(&recording.position_rad),
            velocity_rad_s: None,
            measurement: recording.measurement.as_ref().map(family),
            unit: recording.unit,
            joints: recording.joints.clone(),
            report: recording.report.clone(),
        }
    }

    fn options(&self, options: &Preprocessing) -> Preprocessing {
        Preprocessing {
            f_dyn_hz: self.f_dyn_hz,
            sample_rate_hz: None,
            position_cutoff_hz: None,
            parallel_cutoff_hz: None,
            ..options.clone()
        }
    }
}

/// The median distance of stamps, s; 1 without two.
pub fn median_period_s(time_s: &[f64]) -> f64 {
    median_step_s(time_s).unwrap_or(1.0)
}
