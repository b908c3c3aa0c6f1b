//! What a result depends on, as a hash.

use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock};

use crate::Experiment;
use aurt_plugins::Registry;
use blake3::Hasher;
use serde_json::Value;

use crate::sweep::SweepError;
use crate::sweep::definition::Validate;

const VERSION: &str = "aurt sweep result 1";

static CODE: OnceLock<PathBuf> = OnceLock::new();

/// States that this code is loaded from a library, not from the program's executable; keys then depend on the library.
pub fn code_is_in(library: PathBuf) {
    // A process loads it once.
    let _ = CODE.set(library);
}

/// Digests of files, each read once.
#[derive(Debug, Default)]
pub struct Digests {
    known: Mutex<HashMap<PathBuf, [u8; 32]>>,
}

impl Digests {
    pub fn of(&self, path: &Path) -> Result<[u8; 32], SweepError> {
        let mut known = self.known.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if let Some(digest) = known.get(path) {
            return Ok(*digest);
        }
        let fail = |source| SweepError::Read { path: path.to_owned(), source };
        let mut hasher = Hasher::new();
        let mut add = |piece: &[u8]| {
            hasher.update(piece);
        };
        aurt_files::read_pieces(path, &mut add).map_err(fail)?;
        let digest = *hasher.finalize().as_bytes();
        known.insert(path.to_owned(), digest);
        Ok(digest)
    }
}

/// The key of a point: a hash of everything that its result depends on. These are the resolved experiment, the contents
/// of every file that it names, how points are judged, and the program: its version, its executable (or [library](code_is_in)) and those
/// of the loaded libraries whose models the experiment has.
pub fn key(
    text: &str,
    experiment: &Experiment,
    (validate, block_s): (Validate, f64),
    registry: &Registry,
    digests: &Digests,
) -> Result<String, SweepError> {
    let mut hash = Hasher::new();
    let mut add = |part: &[u8]| {
        // With their lengths, parts cannot run into each other.
        hash.update(&(part.len() as u64).to_le_bytes());
        hash.update(part);
    };
    add(VERSION.as_bytes());
    add(env!("CARGO_PKG_VERSION").as_bytes());
    if let Some(program) = CODE.get().cloned().or_else(|| std::env::current_exe().ok()) {
        add(&digests.of(&program)?);
    }
    let used = libraries_of(experiment);
    for library in registry.libraries() {
        if used.as_ref().is_some_and(|used| !used.contains(&*library.path.to_string_lossy())) {
            continue;
        }
        add(library.name.as_bytes());
        add(library.version.as_bytes());
        add(&digests.of(&library.path)?);
    }
    add(text.as_bytes());
    add(format!("{validate:?} {block_s:?}").as_bytes());
    // A robot known by name has no file; its name is part of the text, its geometry of the program.
    if let Some(path) = experiment.robot.geometry.path() {
        add(&digests.of(path)?);
    }
    let recordings = &experiment.recordings;
    for source in recordings.calibration.iter().chain(&recordings.validation) {
        add(&digests.of(&source.file)?);
        for other in &source.recorded.joined {
            add(&digests.of(&other.file)?);
        }
    }
    Ok(hash.finalize().to_hex().as_str()[..40].to_owned())
}

/// The libraries whose models an experiment has; nothing where that cannot be told.
///
/// Others that happen to be loaded, because another point of the sweep names them, change nothing about this one.
fn libraries_of(experiment: &Experiment) -> Option<BTreeSet<String>> {
    let stacks = experiment.joint_dynamics.stacks(experiment.joints()).ok()?;
    let mut models = Vec::new();
    for stack in &stacks {
        models.push(serde_json::to_value(stack.coulomb()).ok()?);
        models.push(serde_json::to_value(stack.hysteresis()).ok()?);
        models.push(serde_json::to_value(stack.viscous()).ok()?);
    }
    for term in &experiment.arm_terms {
        models.push(serde_json::to_value(&**term).ok()?);
    }
    let mut used = BTreeSet::new();
    models.iter().for_each(|model| collect_libraries(model, &mut used));
    Some(used)
}

/// Saved models of libraries say which file they are from, also where they are part of another model.
fn collect_libraries(saved: &Value, used: &mut BTreeSet<String>) {
    match saved {
        Value::Object(keys) => {
            used.extend(saved["plugin"]["library"].as_str().map(str::to_owned));
            keys.values().for_each(|value| collect_libraries(value, used));
        }
        Value::Array(list) => list.iter().for_each(|value| collect_libraries(value, used)),
        _ => {}
    }
}
