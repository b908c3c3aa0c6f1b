//! How a machine has changed since its calibration, recording after recording.

use std::path::{Path, PathBuf};

use aurt_calibration::{
    Baseline, CalibrationError, ChangePoint, Cusum, Drift, DriftGroup, DriftParameter, DriftReference,
    NamedRecording, Solution, System, Tracker, average_run_length, drift_windows, threshold_for,
};
use aurt_experiment::{Experiment, Registry};
use aurt_traits::{ArmTerm, LoadTorque, MeasurementUnit, RobotModel};
use serde::Serialize;
use serde_json::json;

use crate::{
    calibrated_file::CalibratedModel,
    data::{Purpose, Source},
    failure::Failure,
    progress::Progress,
};

/// Shift per window, in deviations, that charts are made for: half of it is the allowance of the CUSUM.
const ALLOWANCE: f64 = 0.5;

/// How drift is followed.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct TrackOptions {
    /// Length of the windows that are compared with the unchanged machine, s.
    pub window_s: f64,
    /// Mean time of recording between two false alarms of the whole arm, h.
    pub false_alarm_h: f64,
    /// Time of recording after which old rows count half in the tracked estimate, for friction, gains and load, s.
    pub half_life_s: [f64; 3],
}

/// A recording's drift.
#[derive(Debug, Clone, Serialize)]
pub struct TrackedRecording {
    /// The recording.
    pub recording: String,
    /// What was measured of it, s.
    pub duration_s: f64,
    /// Windows that entered the charts.
    pub windows: usize,
    /// Drift of this recording alone, in the order of the parameters.
    pub drift: Vec<Drift>,
    /// Tracked estimate at its end, with forgetting.
    pub tracked: Vec<Drift>,
}

/// A change that charts found.
#[derive(Debug, Clone, Serialize)]
pub struct Alarm {
    /// What changed.
    pub group: DriftGroup,
    /// Its joint; none for the load.
    pub joint: Option<usize>,
    /// The parameter.
    pub parameter: String,
    /// Whether it rose.
    pub rose: bool,
    /// The recording in which the change began.
    pub since_recording: String,
    /// From that recording's first stamp, s.
    pub since_s: f64,
    /// The recording in which it was certain.
    pub certain_recording: String,
    /// End of the window in which it was certain, from that recording's first stamp, s.
    pub certain_s: f64,
}

/// What was found.
#[derive(Debug, Clone, Serialize)]
pub struct Tracked {
    /// How.
    pub options: TrackOptions,
    /// The parameters.
    pub parameters: Vec<DriftParameter>,
    /// The unchanged machine.
    pub baseline: Baseline,
    /// Recordings of the unchanged machine.
    pub baseline_recordings: Vec<String>,
    /// Charts, and their threshold in deviations.
    pub charts: usize,
    /// Threshold of the CUSUM, in deviations.
    pub threshold: f64,
    /// Mean number of windows between two false alarms of one chart.
    pub average_run_length_windows: f64,
    /// The recordings, in time order.
    pub recordings: Vec<TrackedRecording>,
    /// Alarms, in the order in which they were certain.
    pub alarms: Vec<Alarm>,
    /// What to know.
    pub notes: Vec<String>,
}

/// Follows a calibrated machine through recordings in time order. The recordings of the experiment are the unchanged
/// machine.
///
/// # Errors
/// What makes a recording unfit, and [`CalibrationError::TooFewWindows`].
pub fn track(
    experiment: &Experiment,
    calibrated: &CalibratedModel,
    registry: &Registry,
    recordings: &[PathBuf],
    options: TrackOptions,
    progress: &Progress,
) -> Result<Tracked, Failure> {
    if experiment.arm_term_recordings.iter().any(Option::is_some) {
        return Err(Failure::Argument {
            option: "EXPERIMENT.toml",
            reason: "an arm term acts in some `recordings` only, and nothing says in which of the tracked ones it does"
                .into(),
            remedy: "calibrate without that term, on recordings without it".into(),
        });
    }
    let calibration = &calibrated.calibration;
    let coefficients = calibration.coefficients();
    let model = with_load(calibrated, registry)?;
    let mut load = calibration.load.clone();
    if let LoadTorque::Fitted(weights) = &mut load {
        weights.resize(model.parameters().len(), 0.0);
    }
    let reference = DriftReference {
        model: &model,
        coefficients: &coefficients,
        load: &load,
        options: &calibration.options,
    };
    let mut follower = Follower::new(&reference, &calibration.sigma, options);
    let sources = experiment.recordings.calibration.iter().chain(&experiment.recordings.validation);
    let sources: Vec<Source> = sources.map(Source::from).collect();
    let (template, names) = (sources.first().cloned(), sources.iter().map(|s| s.label.clone()).collect());
    let mut unchanged = Vec::new();
    for source in sources {
        progress.step(format!("the unchanged machine: {}", source.label));
        let recording = prepared(calibrated, source)?;
        for window in drift_windows(&reference, &recording, options.window_s)?.iter().filter(|w| w.whole) {
            unchanged.push(follower.solve(&window.system)?);
        }
    }
    let baseline = Baseline::learn(&unchanged)?;
    follower.chart(&baseline);
    for path in recordings {
        progress.step(path.display().to_string());
        // Files of one machine are alike: what the experiment says of columns and units holds for these.
        let (unit, columns) = template.as_ref().map_or((None, None), |t| (t.unit, t.columns.clone()));
        let label = path.display().to_string();
        let source = Source { file: path.clone(), label, window_s: None, unit, columns };
        let recording = prepared(calibrated, source)?;
        follower.follow(&reference, &recording, &baseline)?;
    }
    Ok(follower.finished(baseline, names, calibration.unit))
}

/// The files of a folder that are recordings, by name; a file stands for itself.
///
/// # Errors
/// [`Failure::Argument`] for folders without any, or that cannot be read.
pub fn recordings_of(paths: &[PathBuf]) -> Result<Vec<PathBuf>, Failure> {
    let mut found = Vec::new();
    for path in paths {
        if !path.is_dir() {
            found.push(path.clone());
            continue;
        }
        let refuse = |reason: String| Failure::Argument {
            option: "RECORDING",
            reason: format!("{} {reason}", path.display()),
            remedy: "name recordings, or a folder of recordings that end in .csv".into(),
        };
        let entries = std::fs::read_dir(path).map_err(|e| refuse(format!("cannot be read: {e}")))?;
        let mut inside = Vec::new();
        for entry in entries {
            let file = entry.map_err(|e| refuse(format!("cannot be read: {e}")))?.path();
            if file.is_file() && file.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv")) {
                inside.push(file);
            }
        }
        if inside.is_empty() {
            return Err(refuse("holds no file that ends in .csv".into()));
        }
        inside.sort();
        found.append(&mut inside);
    }
    Ok(found)
}

fn prepared(calibrated: &CalibratedModel, source: Source) -> Result<NamedRecording, Failure> {
    let pipeline = calibrated.pipeline();
    let loaded = pipeline.read(source, Purpose::Calibration)?;
    let unit = pipeline
        .unit(&loaded)
        .ok_or_else(|| CalibrationError::NoMeasurement { file: loaded.source.file.clone() })?;
    if unit != calibrated.calibration.unit {
        return Err(Failure::MixedUnits {
            first: Path::new("the calibrated model").to_owned(),
            first_unit: calibrated.calibration.unit,
            other: loaded.source.file,
            other_unit: unit,
        });
    }
    pipeline.preprocess(&loaded, Purpose::Calibration)
}

/// The model with a body on its last link; without one where masses have no unit, in amperes.
fn with_load(calibrated: &CalibratedModel, registry: &Registry) -> Result<RobotModel, Failure> {
    let model = &calibrated.model;
    if calibrated.calibration.unit == MeasurementUnit::Ampere {
        return Ok(model.clone());
    }
    let load = json!({ "model": "payload", "parameters": ["m", "mX", "mY", "mZ"] });
    let load: Box<dyn ArmTerm> = registry.build_from_json(&load).map_err(Failure::Build)?;
    let terms = model.arm_terms().iter().cloned().chain([load]).collect();
    RobotModel::new(model.rigid_body().clone(), model.base().clone(), model.stacks().to_vec(), terms)
        .map_err(Failure::Models)
}

/// A parameter's chart.
struct Chart {
    parameter: usize,
    cusum: Cusum,
    /// Start and end of each window that was charted, with the index of its recording.
    places: Vec<(usize, f64, f64)>,
    is_silent: bool,
}

/// What has been seen so far.
struct Follower {
    options: TrackOptions,
    parameters: Vec<DriftParameter>,
    sigma: Vec<f64>,
    columns: Vec<Vec<usize>>,
    tracker: Tracker,
    charts: Vec<Chart>,
    run_length: f64,
    threshold: f64,
    recordings: Vec<TrackedRecording>,
    alarms: Vec<Alarm>,
    notes: Vec<String>,
}

impl Follower {
    fn new(reference: &DriftReference<'_>, sigma: &[f64], options: TrackOptions) -> Self {
        let (parameters, columns) = (reference.parameters(), reference.columns());
        Self {
            options,
            tracker: Tracker::new(parameters.len(), columns.clone(), sigma),
            parameters,
            sigma: sigma.to_vec(),
            columns,
            charts: Vec::new(),
            run_length: f64::INFINITY,
            threshold: 0.0,
            recordings: Vec::new(),
            alarms: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// The drift that rows alone show.
    fn solve(&self, rows: &System) -> Result<Solution, CalibrationError> {
        let mut alone = Tracker::new(self.parameters.len(), self.columns.clone(), &self.sigma);
        alone.add(rows)?;
        alone.estimate()
    }

    /// A chart for every joint's friction and gain and for the mass of the load, where the baseline determines it; their
    /// false alarms together come as seldom as asked for.
    fn chart(&mut self, baseline: &Baseline) {
        let is_charted = |k: &usize| {
            let p = &self.parameters[*k];
            baseline.windows[*k] >= aurt_calibration::MIN_WINDOWS && (p.joint.is_some() || p.unit == "kg")
        };
        let charted: Vec<usize> = (0..self.parameters.len()).filter(is_charted).collect();
        let windows = self.options.false_alarm_h * 3600.0 / self.options.window_s;
        self.run_length = windows * charted.len() as f64;
        self.threshold = threshold_for(ALLOWANCE, self.run_length);
        self.run_length = average_run_length(ALLOWANCE, self.threshold);
        self.charts = charted
            .into_iter()
            .map(|parameter| Chart {
                parameter,
                // What the baseline's mean may be off by comes back in every window: it is no change.
                cusum: Cusum::new(ALLOWANCE + baseline.mean_error(parameter), self.threshold),
                places: Vec::new(),
                is_silent: false,
            })
            .collect();
    }

    /// Takes in the next recording.
    fn follow(
        &mut self,
        reference: &DriftReference<'_>,
        recording: &NamedRecording,
        baseline: &Baseline,
    ) -> Result<(), Failure> {
        let windows = drift_windows(reference, recording, self.options.window_s)?;
        let number = self.recordings.len();
        let mut whole: Option<System> = None;
        let mut certain: Vec<(usize, ChangePoint)> = Vec::new();
        for window in &windows {
            match &mut whole {
                None => whole = Some(window.system.clone()),
                Some(sum) => sum.merge(&window.system)?,
            }
            self.tracker.forget(&self.kept(window.duration_s))?;
            self.tracker.add(&window.system)?;
            if !window.whole {
                continue;
            }
            let solution = self.solve(&window.system)?;
            for (k, chart) in self.charts.iter_mut().enumerate() {
                let drift = baseline.drift(&solution, chart.parameter);
                let Some(z) = drift.standardised.filter(|z| z.is_finite()) else { continue };
                chart.places.push((number, window.start_s, window.start_s + window.duration_s));
                if let Some(change) = chart.cusum.push(z).filter(|_| !chart.is_silent) {
                    chart.is_silent = true;
                    certain.push((k, change));
                }
            }
        }
        let charted = windows.iter().filter(|w| w.whole).count();
        if charted == 0 {
            self.notes.push(format!(
                "{} is shorter than a window of {} s: its drift is estimated, but not charted",
                recording.name, self.options.window_s
            ));
        }
        let whole = whole.ok_or(CalibrationError::NothingToCalibrateOn)?;
        let (alone, followed) = (self.solve(&whole)?, self.tracker.estimate()?);
        let all = 0..self.parameters.len();
        self.recordings.push(TrackedRecording {
            recording: recording.name.clone(),
            duration_s: windows.iter().map(|w| w.duration_s).sum(),
            windows: charted,
            drift: all.clone().map(|k| baseline.drift(&alone, k)).collect(),
            tracked: all.map(|k| baseline.drift(&followed, k)).collect(),
        });
        for (chart, change) in certain {
            let alarm = self.alarm(&self.charts[chart], change);
            self.alarms.push(alarm);
        }
        Ok(())
    }

    /// The share of its information that each parameter keeps over some seconds.
    fn kept(&self, duration_s: f64) -> Vec<f64> {
        let half_life_s = |p: &DriftParameter| self.options.half_life_s[p.group as usize];
        self.parameters.iter().map(|p| (-duration_s / half_life_s(p)).exp2()).collect()
    }

    fn alarm(&self, chart: &Chart, change: ChangePoint) -> Alarm {
        let parameter = &self.parameters[chart.parameter];
        let (since, certain) = (chart.places[change.since], chart.places[change.certain_at]);
        Alarm {
            group: parameter.group,
            joint: parameter.joint,
            parameter: parameter.name.clone(),
            rose: change.rose,
            since_recording: self.recordings[since.0].recording.clone(),
            since_s: since.1,
            certain_recording: self.recordings[certain.0].recording.clone(),
            certain_s: certain.2,
        }
    }

    fn finished(
        mut self,
        baseline: Baseline,
        baseline_recordings: Vec<String>,
        unit: MeasurementUnit,
    ) -> Tracked {
        if unit == MeasurementUnit::Ampere {
            self.notes.push(
                "the model is in A, where a mass has no unit: a load shows as gains; `torque_constants_nm_per_a` makes it kg"
                    .into(),
            );
        }
        Tracked {
            options: self.options,
            baseline,
            baseline_recordings,
            charts: self.charts.len(),
            threshold: self.threshold,
            average_run_length_windows: self.run_length,
            parameters: self.parameters,
            recordings: self.recordings,
            alarms: self.alarms,
            notes: self.notes,
        }
    }
}
