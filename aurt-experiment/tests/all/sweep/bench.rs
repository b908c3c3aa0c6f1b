//! An experiment on disk, and a loader that reads its recordings.

use std::fs;
use std::path::{Path, PathBuf};

use aurt::data::Source;
use aurt_calibration::{CalibrationOptions, NamedRecording, ShapeOptions, ValidatedRows};
use aurt_experiment::Experiment;
use aurt_experiment::sweep::{
    Data, Folder, Loader, Outcome, Plan, PointError, PointResult, Settings, Summary, Sweep, SweepError,
    Validate, run,
};
use aurt_plugins::Registry;
use aurt_recording::{PreprocessOptions, ReadOptions, preprocess, read_recording};
use aurt_simulation::robots::two_link;
use aurt_simulation::{Motion, Robot, Rotors, Scenario, simulate};
use aurt_traits::MeasurementUnit;
use tempfile::TempDir;

/// The part of an experiment that sweeps vary.
pub const BASE: &str = include_str!("base.toml");

/// A folder with an experiment and its recordings.
pub struct Bench {
    pub folder: TempDir,
}

impl Bench {
    /// A bench whose experiment has this `[sweep]`.
    pub fn new(sweep: &str) -> Self {
        let bench = Self { folder: tempfile::tempdir().unwrap() };
        fs::write(bench.path("mdh.csv"), arm().mdh_csv()).unwrap();
        for (k, name) in ["a.csv", "b.csv", "c.csv", "d.csv"].into_iter().enumerate() {
            fs::write(bench.path(name), recording(k as u64 + 1)).unwrap();
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

/// A two-link arm in a vertical plane, with Coulomb friction that grows with the load and viscous friction.
fn arm() -> Robot {
    let mut robot = two_link().with_rotors(Rotors::InLinks);
    robot.drives.iter_mut().for_each(|drive| drive.load_coefficient = 0.15);
    robot
}

/// 12 s of the arm.
fn recording(seed: u64) -> Vec<u8> {
    let motion = Motion::MultiSine { duration_s: 12.0, harmonics: 5, top_hz: 0.8, share: 0.5 };
    let trajectory = motion.plan(&arm(), seed).unwrap();
    simulate(&Scenario::new(arm(), trajectory, seed)).unwrap().csv()
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
