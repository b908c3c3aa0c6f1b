//! An experiment on disk.

use std::fs;
use std::path::{Path, PathBuf};

use aurt_experiment::sweep::{Folder, Outcome, Plan, PointResult, Summary, Sweep, SweepError, run};
use aurt_plugins::Registry;
use aurt_simulation::robots::two_link;
use aurt_simulation::{Motion, Robot, Rotors, Scenario, simulate};
use tempfile::TempDir;

/// The part of an experiment that sweeps vary.
pub const BASE: &str = include_str!("base.toml");

/// A folder with an experiment and its recordings.
pub struct Bench {
    pub folder: TempDir,
}

impl Bench {
    pub fn new(sweep: &str) -> Self {
        let bench = Self { folder: tempfile::tempdir().unwrap() };
        fs::write(bench.path("mdh.csv"), arm().mdh_csv()).unwrap();
        for (k, name) in ["a.csv", "b.csv", "c.csv", "d.csv"].into_iter().enumerate() {
            fs::write(bench.path(name), recording(k as u64 + 1)).unwrap();
        }
        bench.write(sweep);
        bench
    }

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
        let summary = run(&sweep, &plan, &folder, &|_| ()).unwrap();
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

/// What a point came to, or why it failed.
pub fn judged(result: &PointResult) -> Result<&aurt_experiment::sweep::Evaluation, &str> {
    match &result.outcome {
        Outcome::Judged(evaluation) => Ok(evaluation),
        Outcome::Failed(error) => Err(error),
    }
}
