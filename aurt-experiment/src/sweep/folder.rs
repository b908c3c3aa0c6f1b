//! A sweep's folder: its plan, one resolved experiment a point, one result a point.
//!
//! ```text
//! sweep.json           the plan: names of the points, keys of their results
//! experiment.toml      the experiment as it was
//! points/0001.toml     the resolved experiment of each point
//! results/KEY.json     results, under the hash of what they depend on
//! table.csv, table.json
//! ```
//!
//! Files appear whole or not at all: they are written beside their place and renamed. A process that is killed leaves no
//! half of one, and the results of others stay. After a power failure a file that the disk lost is a result that is not
//! there, and is made again; so is a result that no longer has its checksum.

use std::collections::BTreeSet;
use std::fs::{self, File, TryLockError};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use aurt_files::output::{STAGED, clear_unfinished, write_file_unsynced};
use serde::Serialize;

use crate::sweep::plan::{self, Plan};
use crate::sweep::result::{Outcome, PointResult};
use crate::sweep::{Sweep, SweepError};

const PLAN: &str = "sweep.json";
const LOCK: &str = "lock";
const EXPERIMENT: &str = "experiment.toml";
const RESULTS: &str = "results";
const POINTS: &str = "points";

#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    /// Held as long as the folder is worked in; the system releases it however the process ends.
    _lock: Option<File>,
    /// Keys of results whose file was there and could not be trusted.
    damaged: Mutex<BTreeSet<String>>,
}

/// Who else may work in a folder at the same time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sharing {
    Exclusive,
    /// Others that write single results.
    Shared,
}

impl Folder {
    fn at(path: &Path) -> Self {
        Self { path: path.to_owned(), _lock: None, damaged: Mutex::default() }
    }

    /// Whether everything in a folder without a plan may be from a sweep that was ended while it was planned. The lock
    /// is the first thing that a sweep makes.
    fn is_unfinished_plan(&self) -> bool {
        let known =
            |name: &str| [LOCK, POINTS, RESULTS, EXPERIMENT].contains(&name) || name.starts_with(STAGED);
        let Ok(entries) = fs::read_dir(&self.path) else { return false };
        let names: Vec<_> = entries.flatten().map(|entry| entry.file_name()).collect();
        names.is_empty()
            || self.file(LOCK).is_file() && names.iter().all(|name| name.to_str().is_some_and(known))
    }

    /// A folder for the sweep of an experiment, made if it does not exist, for this process alone.
    pub fn for_sweep(path: &Path, sweep: &Sweep) -> Result<Self, SweepError> {
        let folder = Self::at(path);
        let refuse = |reason: &str, remedy: &str| refused(path.to_owned(), reason, remedy);
        match fs::read_dir(path) {
            Ok(_) => {
                if !folder.file(PLAN).exists() && !folder.is_unfinished_plan() {
                    return Err(refuse("holds files that are no sweep's", "name a new or an empty folder"));
                }
            }
            Err(e) if e.kind() == ErrorKind::NotFound => {}
            Err(source) if source.kind() == ErrorKind::NotADirectory => {
                return Err(refuse("is a file", "name a folder"));
            }
            Err(source) => return Err(SweepError::Read { path: path.to_owned(), source }),
        }
        fs::create_dir_all(path).map_err(|source| SweepError::Write { path: path.to_owned(), source })?;
        let folder = folder.locked(Sharing::Exclusive)?;
        if folder.file(PLAN).exists() {
            let experiment = sweep.path.canonicalize().unwrap_or_else(|_| sweep.path.clone());
            let plan = folder.plan()?;
            if plan.experiment != experiment {
                let other = plan.experiment.display();
                let reason = format!("holds the results of another experiment, {other}");
                return Err(refuse(&reason, "name another folder"));
            }
        }
        folder.clear_unfinished();
        Ok(folder)
    }

    /// The folder of a planned sweep, to be read.
    pub fn planned(path: &Path) -> Result<Self, SweepError> {
        let folder = Self::at(path);
        if !folder.file(PLAN).is_file() {
            let remedy = "make one with `aurt sweep run EXPERIMENT --out DIR` or `aurt sweep plan`";
            return Err(refused(path.to_owned(), "holds no sweep", remedy));
        }
        Ok(folder)
    }

    /// The folder of a planned sweep, to add single results while others do so too.
    pub fn shared(path: &Path) -> Result<Self, SweepError> {
        Self::planned(path)?.locked(Sharing::Shared)
    }

    fn locked(self, sharing: Sharing) -> Result<Self, SweepError> {
        let path = self.file(LOCK);
        let fail = |source| SweepError::Write { path: path.clone(), source };
        let file = File::options().create(true).truncate(false).write(true).open(&path).map_err(fail)?;
        let taken = match sharing {
            Sharing::Exclusive => file.try_lock(),
            Sharing::Shared => file.try_lock_shared(),
        };
        match taken {
            Ok(()) => Ok(Self { _lock: Some(file), ..self }),
            Err(TryLockError::WouldBlock) => Err(SweepError::Locked { path: self.path }),
            Err(TryLockError::Error(source)) => Err(fail(source)),
        }
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// The file of a point's resolved experiment; points are numbered from 1.
    pub fn point_file(&self, number: usize) -> PathBuf {
        self.file(POINTS).join(format!("{number:04}.toml"))
    }

    pub fn plan(&self) -> Result<Plan, SweepError> {
        let path = self.file(PLAN);
        let text = aurt_files::read_regular(&path, aurt_files::MOST_MODEL_BYTES)
            .and_then(aurt_files::text_of)
            .map_err(|source| SweepError::Read { path, source })?;
        let refuse = |reason: String| refused(self.file(PLAN), &reason, "plan again in a new folder");
        let plan: Plan =
            serde_json::from_str(&text).map_err(|e| refuse(format!("is no plan of this version: {e}")))?;
        if plan.schema != plan::SCHEMA {
            return Err(refuse(format!(
                "is a plan of version {}, this program reads {}",
                plan.schema,
                plan::SCHEMA
            )));
        }
        if plan.reference >= plan.points.len() {
            return Err(refuse(format!(
                "has {} points, and point {} is to be its reference",
                plan.points.len(),
                plan.reference
            )));
        }
        Ok(plan)
    }

    /// Writes the plan, the experiment and every point's; points of an earlier plan go, results stay.
    pub fn write_plan(&self, sweep: &Sweep, plan: &Plan) -> Result<(), SweepError> {
        for name in [POINTS, RESULTS] {
            let path = self.file(name);
            fs::create_dir_all(&path).map_err(|source| SweepError::Write { path, source })?;
        }
        let source = sweep.path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        let source = aurt_files::harmless(&source);
        for (k, point) in sweep.points.iter().enumerate() {
            let name = aurt_files::harmless(&point.name);
            let text = format!("# Point {} of the sweep of {source}: {name}\n\n{}", k + 1, point.text);
            write_whole(&self.point_file(k + 1), text.as_bytes())?;
        }
        let mut beyond = sweep.points.len() + 1;
        while fs::remove_file(self.point_file(beyond)).is_ok() {
            beyond += 1;
        }
        write_whole(&self.file(EXPERIMENT), sweep.text.as_bytes())?;
        write_json(&self.file(PLAN), plan)
    }

    /// A point's result, if there is one; a file that cannot be understood or was changed is none, see
    /// [`Self::damaged`].
    pub fn result(&self, key: &str) -> Option<PointResult> {
        let bytes = aurt_files::read_bytes(&self.result_file(key), aurt_files::MOST_MODEL_BYTES).ok()?;
        let result: Option<PointResult> = serde_json::from_slice(&bytes).ok();
        let whole = result.filter(|result| result.is_whole(key));
        if whole.is_none() {
            let mut damaged = self.damaged.lock().unwrap_or_else(PoisonError::into_inner);
            damaged.insert(key.to_owned());
        }
        whole
    }

    /// The files of results that were met so far and are not what was written: cut off, another version's, or changed.
    pub fn damaged(&self) -> Vec<PathBuf> {
        let damaged = self.damaged.lock().unwrap_or_else(PoisonError::into_inner);
        damaged.iter().map(|key| self.result_file(key)).collect()
    }

    pub fn keep(&self, key: &str, outcome: Outcome) -> Result<(), SweepError> {
        let path = self.result_file(key);
        let fail = |e: serde_json::Error| SweepError::Write { path: path.clone(), source: e.into() };
        write_json(&path, &PointResult::new(key, outcome).map_err(fail)?)
    }

    fn result_file(&self, key: &str) -> PathBuf {
        self.file(RESULTS).join(format!("{key}.json"))
    }

    /// Removes what a killed process left half-written.
    fn clear_unfinished(&self) {
        for name in ["", POINTS, RESULTS] {
            clear_unfinished(&self.file(name));
        }
    }
}

fn refused(path: PathBuf, reason: &str, remedy: &str) -> SweepError {
    SweepError::Folder { path, reason: reason.to_owned(), remedy: remedy.to_owned() }
}

fn write_json(path: &Path, value: &impl Serialize) -> Result<(), SweepError> {
    let fail = |source| SweepError::Write { path: path.to_owned(), source };
    let mut text = serde_json::to_vec_pretty(value).map_err(|e| fail(e.into()))?;
    text.push(b'\n');
    write_whole(path, &text)
}

/// Writes a file so that nobody ever sees half of it.
fn write_whole(path: &Path, contents: &[u8]) -> Result<(), SweepError> {
    if aurt_files::read_regular(path, aurt_files::MOST_MODEL_BYTES).is_ok_and(|old| old == contents) {
        return Ok(());
    }
    // A point can be judged again; a hundred thousand waits for the disk would take longer.
    Ok(write_file_unsynced(path, contents)?)
}
