//! How a machine has changed since its calibration, recording after recording or row after row.

mod follower;
mod running;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::Experiment;
use aurt::data::{Loaded, Purpose, Source};
use aurt::duplicates::{SampleRegister, UsedSeries};
use aurt::{CalibratedModel, Progress};
use aurt_calibration::{
    Baseline, CalibrationError, Cut, Drift, DriftEstimate, DriftGroup, DriftParameter, DriftReference,
    DriftWindow, LeftOut, NamedRecording, TermScopes, accumulate, drift_windows,
};
use aurt_plugins::Registry;
use aurt_rbd::INERTIAL_PARAMETERS;
use aurt_recording::{BranchMotion, FORMATS, RecordedAs, Recording, is_recording_folder};
use aurt_traits::{ArmTerm, LoadTorque, MeasurementUnit, RigidBodyRegressor, RobotModel};
use serde::Serialize;
use serde_json::json;

use self::follower::Follower;
use self::running::Running;
use crate::workbench::experiments::check_robot_of;
use crate::workbench::failure::Failure;

#[derive(Debug, Clone, Serialize)]
pub struct TrackOptions {
    /// How the recordings are read, where it is another way than the experiment's.
    #[serde(skip)]
    pub recorded: RecordedAs,
    /// Length of the windows that are compared with the unchanged machine, s.
    pub window_s: f64,
    /// Mean time of recording between two false alarms of the whole arm, h.
    pub false_alarm_h: f64,
    /// Time of recording after which old rows count half in the tracked estimate, for friction, gains and load, s.
    pub half_life_s: [f64; 3],
}

impl TrackOptions {
    /// A motion goes on after a pause that is shorter, s.
    const fn longest_pause_s(&self) -> f64 {
        2.0 * self.window_s
    }

    /// Whether a recording that begins at a stamp is of the motion of one that ended at another: clocks cut logs in the middle of one.
    fn continues(&self, ended_s: f64, first_s: f64) -> bool {
        (0.0..self.longest_pause_s()).contains(&(first_s - ended_s))
    }
}

#[derive(Debug, Clone, Serialize)]
pub struct TrackedRecording {
    pub recording: String,
    pub duration_s: f64,
    /// Windows that entered the charts; a stretch that is too short for one enters the estimates only.
    pub windows: usize,
    /// Drift of this recording alone, in the order of the parameters.
    pub drift: Vec<Drift>,
    /// Tracked estimate at its end, with forgetting.
    pub tracked: Vec<Drift>,
}

/// A change that charts found.
#[derive(Debug, Clone, Serialize)]
pub struct Alarm {
    pub group: DriftGroup,
    /// Its joint; none for the load.
    pub joint: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joint_name: Option<String>,
    pub parameter: String,
    pub rose: bool,
    pub since_recording: String,
    /// From that recording's first stamp, s.
    pub since_s: f64,
    pub certain_recording: String,
    /// End of the window in which it was certain, from that recording's first stamp, s.
    pub certain_s: f64,
}

#[derive(Debug, Clone, Serialize)]
pub struct Tracked {
    pub options: TrackOptions,
    pub parameters: Vec<DriftParameter>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub joint_names: Vec<String>,
    pub baseline: Baseline,
    pub baseline_recordings: Vec<String>,
    pub charts: usize,
    pub threshold: f64,
    /// Mean number of windows between two false alarms of one chart.
    pub average_run_length_windows: f64,
    pub recordings: Vec<TrackedRecording>,
    /// Alarms, in the order in which they were certain.
    pub alarms: Vec<Alarm>,
    pub notes: Vec<String>,
}

#[derive(Debug, Clone)]
pub enum Followed {
    /// A file, or [`STANDARD_INPUT`].
    File(PathBuf),
    Recording(Arc<Recording>),
}

impl Followed {
    /// Whether its rows come on standard input.
    pub fn is_running(&self) -> bool {
        matches!(self, Self::File(path) if path.as_path() == Path::new(STANDARD_INPUT))
    }
}

pub const SHORTEST_WINDOW_S: f64 = 1.0;
/// The name of rows that come on standard input.
pub const STANDARD_INPUT: &str = "-";

/// Follows a calibrated machine through recordings in time order. The
/// recordings of the experiment are the unchanged machine. `said` hears of each alarm as soon as it is certain.
pub fn track(
    experiment: &Experiment,
    calibrated: &CalibratedModel,
    registry: &Registry,
    recordings: &[Followed],
    options: TrackOptions,
    progress: &Progress,
    said: &mut dyn FnMut(&Alarm),
) -> Result<Tracked, Failure> {
    if experiment.arm_term_recordings.iter().any(Option::is_some) {
        return Err(Failure::argument(
            "EXPERIMENT.toml",
            "an arm term acts in some `recordings` only, and nothing says in which of the tracked ones it does",
            "calibrate without that term, on recordings without it",
        ));
    }
    check_robot_of(calibrated, experiment)?;
    let calibration = &calibrated.calibration;
    let model = with_load(calibrated, registry)?;
    let mut load = calibration.load.clone();
    if let LoadTorque::Fitted(weights) = &mut load {
        weights.resize(model.parameters().len(), 0.0);
    }
    let sources = experiment.recordings.fitted_and_held_out();
    let sources: Vec<Source> = sources.map(|(source, _)| source.clone()).collect();
    let (template, names) = (sources.first().cloned(), sources.iter().map(|s| s.label.clone()).collect());
    let UnchangedMachine { motions: unchanged, without, base, notes } =
        UnchangedMachine::read(calibrated, sources, &options, progress)?;
    let LeftOut { all, others } = left_out(calibrated, &unchanged)?;
    let reference =
        DriftReference { model: &model, coefficients: &all, load: &load, options: &calibration.options };
    let mut motions = Vec::new();
    let mut without = without.iter();
    for (recordings, coefficients) in unchanged.iter().zip(&others) {
        let reference = DriftReference { coefficients, ..reference };
        let mut windows = Vec::new();
        for (recording, left_out) in recordings.iter().zip(without.by_ref()) {
            windows.extend(drift_windows(&reference, recording, left_out, Cut::whole(options.window_s))?);
        }
        let whole = windows.iter().filter(|w| w.whole);
        let estimate = |w: &DriftWindow| Ok(DriftEstimate::of(&w.system, &calibration.sigma)?.solution);
        motions.push(whole.map(estimate).collect::<Result<Vec<_>, CalibrationError>>()?);
    }
    drop(unchanged);
    let learnt = (Baseline::learn(&motions)?, names);
    let mut follower = Follower::new(&reference, &calibration.sigma, options.clone(), learnt, notes);
    // A recording of the unchanged machine may be followed: it shows what no change looks like.
    let mut samples = SampleRegister::default();
    // Files of one machine are alike: what the experiment says of columns and units holds for these.
    for followed in recordings {
        let is_running = followed.is_running();
        let label = match followed {
            Followed::File(_) if is_running => "standard input".to_owned(),
            Followed::File(path) => path.display().to_string(),
            Followed::Recording(recording) => recording.file.display().to_string(),
        };
        progress.step(label.clone());
        // Files that belong to a recording of the experiment do not belong to these.
        let alone = |recorded: &RecordedAs| RecordedAs {
            joined: Vec::new(),
            ..options.recorded.clone().or(recorded)
        };
        let (unit, columns, recorded) = template
            .as_ref()
            .map_or_else(Default::default, |t| (t.unit, t.columns.clone(), alone(&t.recorded)));
        let loaded = match followed {
            Followed::Recording(recording) => Loaded::of(recording, &calibrated.pipeline().joints)?,
            Followed::File(path) => {
                let source = Source { file: path.clone(), label, window_s: None, unit, columns, recorded };
                if is_running {
                    Running::new(&mut follower, &reference, calibrated, source).follow(said)?;
                    continue;
                }
                calibrated.pipeline().read(source, Purpose::Calibration)?
            }
        };
        samples.add(&UsedSeries::of(&loaded.source, &loaded.recording, "followed"))?;
        follower.tracked.notes.extend(loaded.warnings());
        let recording = prepared_of(calibrated, &loaded)?;
        let left_out = contaminated(&loaded);
        let moved = BranchMotion::elsewhere(&loaded.recording.report.branches, &base);
        if moved.is_some() || left_out.len() == calibrated.model.joints() {
            let note =
                "no joint is without motion or a posture of joints outside the model: nothing is followed";
            follower.tracked.notes.push(format!("{}: {note}", recording.name));
            continue;
        }
        let windows = drift_windows(&reference, &recording, &left_out, Cut::whole(options.window_s))?;
        follower.begin(recording.name.clone(), span_s(&loaded));
        for window in windows {
            if let Some(alarm) = follower.take(&window)? {
                said(&alarm);
            }
        }
        follower.close(recording.name)?;
    }
    let mut tracked = follower.tracked;
    if calibration.unit == MeasurementUnit::Ampere {
        tracked.notes.push(
            "the model is in A, where a mass has no unit: a load shows as gains; `torque_constants_nm_per_a` makes it kg"
                .into(),
        );
    }
    Ok(tracked)
}

#[derive(Default)]
struct UnchangedMachine {
    motions: Vec<Vec<NamedRecording>>,
    /// The joints of each recording whose rows do not count.
    without: Vec<Vec<usize>>,
    /// Motions beside the chain in the first of them.
    base: Vec<BranchMotion>,
    notes: Vec<String>,
}

impl UnchangedMachine {
    fn read(
        calibrated: &CalibratedModel,
        sources: Vec<Source>,
        options: &TrackOptions,
        progress: &Progress,
    ) -> Result<Self, Failure> {
        let mut unchanged = Self::default();
        if ends_in_branches(&**calibrated.model.rigid_body()) {
            unchanged.notes.push("the robot is a tree: a load on one of its ends shows as gains".into());
        }
        let mut ended_s = f64::NEG_INFINITY;
        let mut samples = SampleRegister::default();
        for (k, source) in sources.into_iter().enumerate() {
            progress.step(format!("the unchanged machine: {}", source.label));
            let loaded = calibrated.pipeline().read(source, Purpose::Calibration)?;
            samples.add(&UsedSeries::of(&loaded.source, &loaded.recording, "the unchanged machine"))?;
            let [first_s, last_s] = span_s(&loaded);
            unchanged.notes.extend(loaded.warnings());
            if k == 0 {
                unchanged.base = loaded.recording.report.branches.clone();
            }
            let recording = prepared_of(calibrated, &loaded)?;
            unchanged.without.push(contaminated(&loaded));
            match unchanged.motions.last_mut().filter(|_| options.continues(ended_s, first_s)) {
                Some(motion) => motion.push(recording),
                None => unchanged.motions.push(vec![recording]),
            }
            ended_s = last_s;
        }
        Ok(unchanged)
    }
}

/// The recordings in a folder, by name: files of every format but `.txt`, which notes have too, and bags that are folders
/// themselves. A file stands for itself.
pub fn recordings_of(paths: &[PathBuf]) -> Result<Vec<PathBuf>, Failure> {
    let mut found = Vec::new();
    for path in paths {
        if path.as_path() == Path::new(STANDARD_INPUT) && found.contains(path) {
            return Err(Failure::argument("RECORDING", "standard input is named twice", "name `-` once"));
        }
        if !path.is_dir() || is_recording_folder(path) {
            found.push(path.clone());
            continue;
        }
        let refuse = |reason: String| {
            Failure::argument(
                "RECORDING",
                format!("{} {reason}", path.display()),
                "name recordings, or a folder with recordings",
            )
        };
        let entries = std::fs::read_dir(path).map_err(|e| refuse(format!("cannot be read: {e}")))?;
        let mut inside = Vec::new();
        for entry in entries {
            let file = entry.map_err(|e| refuse(format!("cannot be read: {e}")))?.path();
            let ending = file.extension().map(|e| e.to_string_lossy().to_lowercase()).filter(|e| e != "txt");
            let is_known = |e: String| FORMATS.iter().any(|format| format.endings.contains(&e.as_str()));
            if file.is_file() && ending.is_some_and(is_known) || is_recording_folder(&file) {
                inside.push(file);
            }
        }
        if inside.is_empty() {
            return Err(refuse("holds no recording".into()));
        }
        inside.sort();
        found.append(&mut inside);
    }
    Ok(found)
}

fn span_s(loaded: &Loaded) -> [f64; 2] {
    let Recording { time_s, report, .. } = &*loaded.recording;
    [time_s.first(), time_s.last()].map(|stamp| stamp.map_or(f64::NAN, |s| report.origin_s + s))
}

/// The coefficients of all motions of the unchanged machine, and of all but each of them.
fn left_out(
    calibrated: &CalibratedModel,
    unchanged: &[Vec<NamedRecording>],
) -> Result<LeftOut, CalibrationError> {
    let (model, calibration) = (&calibrated.model, &calibrated.calibration);
    let of = |motion: &Vec<NamedRecording>| {
        accumulate(model, motion, &TermScopes::everywhere(), &calibration.load, &calibration.options)
    };
    let systems = unchanged.iter().map(of).collect::<Result<Vec<_>, _>>()?;
    LeftOut::of(&systems, &calibration.sigma, |k| calibration.parameters[k].excited)
}

fn prepared_of(calibrated: &CalibratedModel, loaded: &Loaded) -> Result<NamedRecording, Failure> {
    let pipeline = calibrated.pipeline();
    let file = &loaded.source.file;
    pipeline.unit(loaded).ok_or_else(|| CalibrationError::NoMeasurement { file: file.clone() })?;
    calibrated.check_unit(loaded)?;
    Ok(pipeline.preprocess(loaded, Purpose::Calibration)?)
}

/// The joints whose measurement contains a motion that the model lacks.
fn contaminated(loaded: &Loaded) -> Vec<usize> {
    let mut joints: Vec<usize> =
        loaded.recording.report.branches.iter().flat_map(|branch| branch.upstream.clone()).collect();
    joints.sort_unstable();
    joints.dedup();
    joints
}

/// Whether the last link does not load every joint: it is the end of one branch among others.
fn ends_in_branches(body: &dyn RigidBodyRegressor) -> bool {
    let parameters = body.standard_parameters().len();
    (0..body.joints()).any(|joint| {
        !(parameters.saturating_sub(INERTIAL_PARAMETERS)..parameters).any(|k| body.loads(k, joint))
    })
}

/// The model with a body on its last link; without one where masses have no unit, in amperes, and on trees.
fn with_load(calibrated: &CalibratedModel, registry: &Registry) -> Result<RobotModel, Failure> {
    let model = &calibrated.model;
    if calibrated.calibration.unit == MeasurementUnit::Ampere || ends_in_branches(&**model.rigid_body()) {
        return Ok(model.clone());
    }
    let load = json!({ "model": "payload", "parameters": ["m", "mX", "mY", "mZ"] });
    let load: Box<dyn ArmTerm> = registry.build_from_json(&load)?;
    let terms = model.arm_terms().iter().cloned().chain([load]).collect();
    RobotModel::new(model.rigid_body().clone(), model.base().clone(), model.stacks().to_vec(), terms)
        .map_err(Into::into)
}
