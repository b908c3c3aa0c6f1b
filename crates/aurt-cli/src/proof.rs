//! Proofs: concealed cases, diagnosed by processes that see nothing but a case's folder, and scored.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

use aurt_simulation::{
    case::{CaseType, Plan, Truth},
    score::{CaseScore, Claim, score},
};
use rayon::prelude::*;
use serde_json::Value;

use crate::failure::Failure;

/// The verdict of a diagnosis.
pub const VERDICT: &str = "verdict.json";
/// What simpler methods would have said, beside it.
pub const COMPARISON: &str = "comparison.json";

/// The folders of a proof.
#[derive(Debug, Clone)]
pub struct Place {
    root: PathBuf,
}

impl Place {
    /// A proof in a folder.
    pub fn new(root: &Path) -> Self {
        Self { root: root.to_owned() }
    }

    /// Folder of the case folders, while they are needed.
    pub fn cases(&self) -> PathBuf {
        self.root.join("cases")
    }

    /// Folder of the truths.
    pub fn sealed(&self) -> PathBuf {
        self.root.join("sealed")
    }

    /// Folder of the verdicts.
    pub fn verdicts(&self) -> PathBuf {
        self.root.join("verdicts")
    }

    /// Folder of the verdicts of diagnoses that were not allowed to know what was in the case.
    pub fn removed(&self) -> PathBuf {
        self.root.join("removed")
    }

    fn create(&self) -> Result<(), Failure> {
        for folder in [self.cases(), self.sealed(), self.verdicts(), self.removed()] {
            fs::create_dir_all(&folder).map_err(|source| Failure::Write { path: folder, source })?;
        }
        Ok(())
    }
}

/// What a proof does beside diagnosing.
#[derive(Debug, Clone, Copy)]
pub struct Options {
    /// Whether cases stay after they were diagnosed.
    pub keep: bool,
    /// Whether every single is diagnosed once more without its candidate.
    pub without: bool,
}

/// Makes, diagnoses and forgets the cases of a plan, on all cores. Cases that were diagnosed before are skipped,
/// so that a proof that was interrupted goes on. Gives what failed: the case and what the diagnosis said.
///
/// # Errors
/// Cases that cannot be made, files that cannot be written.
pub fn prove(
    plan: &Plan,
    seed: u64,
    place: &Place,
    options: Options,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<BTreeMap<String, String>, Failure> {
    place.create()?;
    let count = plan.requests(seed)?.len();
    let failed = (0..count)
        .into_par_iter()
        .map(|index| {
            let name = Plan::case_name(index);
            let complaint = prove_case(plan, seed, index, place, options)?;
            progress(&name);
            Ok(complaint.map(|complaint| (name, complaint)))
        })
        .collect::<Result<Vec<Option<(String, String)>>, Failure>>()?;
    Ok(failed.into_iter().flatten().collect())
}

fn prove_case(
    plan: &Plan,
    seed: u64,
    index: usize,
    place: &Place,
    options: Options,
) -> Result<Option<String>, Failure> {
    let name = Plan::case_name(index);
    let request = &plan.requests(seed)?[index];
    let verdict = place.verdicts().join(&name);
    let blind = (options.without && request.case_type == CaseType::Single)
        .then(|| (place.removed().join(&name), request.effects[0].clone()));
    let missing = |folder: &Path| !folder.join(VERDICT).exists();
    if !missing(&verdict) && blind.as_ref().is_none_or(|(folder, _)| !missing(folder)) {
        return Ok(None);
    }
    // A case that cannot be made is no case; it is named, and the others go on.
    let case = match plan.make(seed, index) {
        Ok(case) => case,
        Err(error) => return Ok(Some(format!("could not be made: {error}"))),
    };
    case.write(&place.cases(), &place.sealed())?;
    let folder = place.cases().join(&name);
    let mut complaint = None;
    if missing(&verdict) {
        complaint = diagnose(&folder, &verdict, &["--compare"])?;
    }
    if let Some((out, effect)) = blind.filter(|(out, _)| missing(out)) {
        complaint = diagnose(&folder, &out, &["--without", &effect])?.or(complaint);
    }
    if !options.keep {
        fs::remove_dir_all(&folder).map_err(|source| Failure::Write { path: folder, source })?;
    }
    Ok(complaint)
}

/// Runs `aurt diagnose` in a case's folder; what it complained of, if it failed. Nothing of the case is in the
/// command but its folder.
fn diagnose(case: &Path, out: &Path, options: &[&str]) -> Result<Option<String>, Failure> {
    let fail = |source| Failure::Write { path: out.to_owned(), source };
    let program = std::env::current_exe().map_err(fail)?;
    let out = std::path::absolute(out).map_err(fail)?;
    let done = Command::new(program)
        .args(["diagnose", "experiment.toml", "--quiet", "--verdict-only", "--out"])
        .arg(&out)
        .args(options)
        .current_dir(case)
        // Cases are diagnosed side by side.
        .env("RAYON_NUM_THREADS", "1")
        .stdin(Stdio::null())
        .output()
        .map_err(fail)?;
    Ok((!matches!(done.status.code(), Some(0 | 1)))
        .then(|| String::from_utf8_lossy(&done.stderr).trim().to_owned()))
}

/// Whose verdicts are scored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Verdicts {
    /// Those of the diagnosis.
    Own,
    /// Those of diagnoses that were not allowed to know the effect.
    Removed,
    /// Those of another method on the same cases.
    Method(String),
}

/// Scores the verdicts of a folder; a case without a verdict is left out.
///
/// # Errors
/// Files that cannot be read.
pub fn read_scores(sealed: &Path, verdicts: &Path, whose: &Verdicts) -> Result<Vec<CaseScore>, Failure> {
    let mut scores = Vec::new();
    for path in truths(sealed)? {
        let truth = Truth::read(&path)?;
        let folder = verdicts.join(&truth.case);
        let claim = match whose {
            Verdicts::Own | Verdicts::Removed => {
                let file = folder.join(VERDICT);
                if file.exists() { Some(Claim::read(file)?) } else { None }
            }
            Verdicts::Method(name) => method(&folder.join(COMPARISON), name)?,
        };
        let removed = truth.effects.first().filter(|_| *whose == Verdicts::Removed);
        if let Some(claim) = claim {
            scores.push(score(&truth, &claim, removed.map(|e| e.effect.as_str())));
        }
    }
    if scores.is_empty() {
        return Err(Failure::Argument {
            option: "--verdicts",
            reason: format!("{} holds no verdict on a case of {}", verdicts.display(), sealed.display()),
            remedy: "each case needs a folder of its name with a verdict.json".into(),
        });
    }
    Ok(scores)
}

/// The truths of a folder, sorted.
fn truths(sealed: &Path) -> Result<Vec<PathBuf>, Failure> {
    let refuse = |reason: String| Failure::Argument {
        option: "--sealed",
        reason,
        remedy: "name the folder that `aurt conceal --sealed` wrote".into(),
    };
    let entries =
        fs::read_dir(sealed).map_err(|e| refuse(format!("{} cannot be read: {e}", sealed.display())))?;
    let mut paths: Vec<PathBuf> = entries
        .filter_map(Result::ok)
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|e| e == "json"))
        .collect();
    paths.sort();
    if paths.is_empty() {
        return Err(refuse(format!("{} holds no truths", sealed.display())));
    }
    Ok(paths)
}

/// What a method said of a case, from its comparison file.
fn method(path: &Path, name: &str) -> Result<Option<Claim>, Failure> {
    let Ok(text) = fs::read_to_string(path) else { return Ok(None) };
    let refuse = |reason: String| Failure::ModelFile {
        path: path.to_owned(),
        reason,
        remedy: "diagnose the case again with --compare".into(),
    };
    let mut all: Value = serde_json::from_str(&text).map_err(|e| refuse(e.to_string()))?;
    match all.get_mut(name).map(Value::take) {
        Some(claim) => serde_json::from_value(claim).map(Some).map_err(|e| refuse(e.to_string())),
        None => Ok(None),
    }
}
