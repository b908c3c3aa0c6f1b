//! An experiment on disk, and a loader that reads its recordings.

use std::{
    fmt::Write,
    fs,
    path::{Path, PathBuf},
};

use aurt::data::Source;
use aurt_calibration::{CalibrationOptions, NamedRecording, ShapeOptions, ValidatedRows};
use aurt_experiment::Experiment;
use aurt_experiment::sweep::{
    Data, Folder, Loader, Outcome, Plan, PointError, PointResult, Settings, Summary, Sweep, SweepError,
    Validate, run,
};
use aurt_plugins::Registry;
use aurt_recording::{PreprocessOptions, ReadOptions, preprocess, read_recording};
use aurt_traits::MeasurementUnit;
use tempfile::TempDir;

/// The part of an experiment that sweeps vary.
pub const BASE: &str = r#"
schema = 1
[robot]
mdh = "mdh.csv"
gravity_m_s2 = [0.0, -9.81, 0.0]
[joint_dynamics]
coulomb = { model = "constant" }
hysteresis = { model = "sign" }
viscous = { model = "polynomial", powers = [1] }
[recordings]
calibration = ["a.csv", "b.csv", "c.csv"]
validation = ["d.csv"]
[preprocess]
f_dyn_hz = 10.0
"#;

/// A folder with an experiment and its recordings.
pub struct Bench {
    pub folder: TempDir,
}

impl Bench {
    /// A bench whose experiment has this `[sweep]`.
    pub fn new(sweep: &str) -> Self {
        let bench = Self { folder: tempfile::tempdir().unwrap() };
        fs::write(bench.path("mdh.csv"), "alpha,a,d\n0,0.5,0\n0,0,0\n").unwrap();
        for (k, name) in ["a.csv", "b.csv", "c.csv", "d.csv"].into_iter().enumerate() {
            fs::write(bench.path(name), recording(20.0 * k as f64, k as u64 + 1)).unwrap();
        }
        bench.write(sweep);
        bench
    }

    /// Gives the experiment another `[sweep]`.
    pub fn write(&self, sweep: &str) {
        fs::write(self.experiment(), format!("{BASE}{sweep}")).unwrap();
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn experiment(&self) -> PathBuf {
        self.path("experiment.toml")
    }

    pub fn read(&self) -> Result<Sweep, SweepError> {
        Sweep::read(&self.experiment(), &mut registry())
    }

    pub fn run(&self, out: &str) -> (Plan, Summary) {
        let sweep = self.read().unwrap();
        let folder = Folder::for_sweep(&self.path(out), &sweep).unwrap();
        let plan = Plan::of(&sweep, &registry()).unwrap();
        folder.write_plan(&sweep, &plan).unwrap();
        let summary = run(&sweep, &plan, &folder, &TestLoader, &|_| ()).unwrap();
        (plan, summary)
    }

    pub fn results(&self, out: &str, plan: &Plan) -> Vec<PointResult> {
        let folder = Folder::planned(&self.path(out)).unwrap();
        plan.points.iter().map(|p| folder.result(&p.key).unwrap()).collect()
    }
}

pub fn registry() -> Registry {
    Registry::linked().unwrap()
}

/// Every file below a folder with its contents, but for the lock.
pub fn contents(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.file_name().unwrap() != "lock" {
                found.push((path.strip_prefix(folder).unwrap().to_owned(), fs::read(&path).unwrap()));
            }
        }
    }
    found.sort();
    found
}

/// 12 s of a two-link arm in a vertical plane (equations of motion in closed form), with Coulomb friction that grows with
/// the load and viscous friction, at 200 Hz.
fn recording(start_s: f64, seed: u64) -> String {
    let mut text = String::from("time,q_0,q_1,torque_0,torque_1\n");
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut noise = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    for k in 0..2400 {
        let t = f64::from(k) / 200.0;
        let joint = |sines: [(f64, f64, f64); 3]| {
            sines.iter().fold([0.0; 3], |[q, v, a], (amplitude, hertz, phase)| {
                let w = std::f64::consts::TAU * hertz;
                let (sin, cos) = (w * (start_s + t) + phase).sin_cos();
                [q + amplitude * sin, v + amplitude * w * cos, a - amplitude * w * w * sin]
            })
        };
        let [q1, v1, a1] = joint([(0.5, 0.13, 0.3), (0.15, 0.41, 1.1), (0.04, 0.93, 2.0)]);
        let [q2, v2, a2] = joint([(0.4, 0.17, 1.9), (0.2, 0.33, 0.2), (0.05, 0.81, 0.9)]);
        let coupling = 2.5 * 0.5 * 0.18;
        let far = 2.5 * 0.18 * 9.81 * (q1 + q2).cos();
        let m12 = 0.14 + coupling * q2.cos();
        let m11 = 0.35 + 0.14 + 2.5 * 0.25 + 2.0 * coupling * q2.cos();
        let rigid = [
            m11 * a1 + m12 * a2 - coupling * q2.sin() * (2.0 * v1 * v2 + v2 * v2)
                + (4.0 * 0.22 + 2.5 * 0.5) * 9.81 * q1.cos()
                + far,
            m12 * a1 + 0.14 * a2 + coupling * q2.sin() * v1 * v1 + far,
        ];
        let torque: Vec<f64> = rigid
            .iter()
            .zip([v1, v2])
            .map(|(load, v)| load + (1.0 + 0.15 * load.abs()) * v.signum() + 2.0 * v + 0.2 * noise())
            .collect();
        writeln!(text, "{t},{q1},{q2},{},{}", torque[0], torque[1]).unwrap();
    }
    text
}

/// Reads recordings as an experiment says, without its instrument.
pub struct TestLoader;

impl TestLoader {
    pub fn read(
        experiment: &Experiment,
        sources: &[Source],
        trim_rest: bool,
    ) -> Result<Vec<NamedRecording>, PointError> {
        let refuse = |e: aurt_recording::RecordingError| PointError::Recordings(e.to_string());
        let p = &experiment.preprocess;
        let options = PreprocessOptions {
            sample_rate_hz: p.sample_rate_hz,
            trim_rest,
            rest_velocity_rad_s: p.rest_velocity_rad_s,
            ..PreprocessOptions::new(p.f_dyn_hz)
        };
        sources
            .iter()
            .map(|source| {
                let recording = read_recording(&source.file, &ReadOptions::default()).map_err(refuse)?;
                let data = preprocess(&recording, &options).map_err(refuse)?;
                Ok(NamedRecording { name: source.label.clone(), data })
            })
            .collect()
    }
}

impl Loader for TestLoader {
    fn load(&self, experiment: &Experiment, validate: Validate) -> Result<Data, PointError> {
        let recordings = &experiment.recordings;
        let judged = match validate {
            Validate::HeldOut => &recordings.validation,
            Validate::LeaveOneOut => &recordings.calibration,
        };
        Ok(Data {
            calibration: Self::read(experiment, &recordings.calibration, true)?,
            judged: Self::read(experiment, judged, false)?,
            unit: MeasurementUnit::NewtonMetre,
            warnings: Vec::new(),
        })
    }

    fn settings(&self, experiment: &Experiment) -> Settings {
        Settings {
            calibration: options(experiment),
            shapes: ShapeOptions::default(),
            rows: ValidatedRows::WhileInMotion,
        }
    }
}

pub fn options(experiment: &Experiment) -> CalibrationOptions {
    CalibrationOptions {
        rest_velocity_rad_s: experiment.preprocess.rest_velocity_rad_s,
        fit_shapes: experiment.calibration.fit_shapes,
        ..CalibrationOptions::default()
    }
}

/// What a point came to, or why it failed.
pub fn judged(result: &PointResult) -> Result<&aurt_experiment::sweep::Evaluation, &str> {
    match &result.outcome {
        Outcome::Judged(evaluation) => Ok(evaluation),
        Outcome::Failed(error) => Err(error),
    }
}
