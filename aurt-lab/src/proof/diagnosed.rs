//! A case from its making to its verdicts.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::case::{CaseType, Plan, Truth};
use crate::product::{Failure, OutputFolder};
use crate::score::leaks;
use aurt_plugins::Trust;
use rayon::prelude::*;
use serde_json::Value;

use super::scores::reference_folder;
use super::variants::Variant;
use super::{FAILED, Place, Shard, Source, UNFIT, VERDICT};

#[derive(Debug, Clone)]
pub struct Options {
    /// Whether cases stay after they were diagnosed.
    pub keep: bool,
    /// Whether every single is diagnosed once more without its candidate.
    pub without: bool,
    /// Whether every single is diagnosed once more with its candidate alone.
    pub oracle: bool,
    /// Number of cases, from the first, that are diagnosed once more in each variant.
    pub varied: usize,
    /// The part of the cases that is made here.
    pub shard: Shard,
    pub program: PathBuf,
    /// The libraries that experiments of cases may name.
    pub trust: Trust,
}

/// Makes, diagnoses and forgets the cases of a world, on all cores. Cases that were diagnosed before are skipped, so that
/// a proof that was interrupted goes on; what a killed one had no time to forget is forgotten. What could not be made or
/// diagnosed is written down, and the others go on.
pub fn prove(
    source: &dyn Source,
    place: &Place,
    options: &Options,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<(), Failure> {
    source.references().par_iter().try_for_each(|name| prove_reference(source, name, place, options))?;
    let proved = (0..source.planned().len())
        .into_par_iter()
        .filter(|index| options.shard.has(*index))
        .try_for_each(|index| {
            prove_case(source, index, place, options)?;
            progress(&Plan::case_name(index));
            Ok(())
        });
    clear_unfinished(place);
    proved
}

/// Removes what killed runs left staged in the folders of a proof and of each case, of which some were killed after their
/// verdict was in its place: such a case is skipped, so no diagnosis clears its folder.
fn clear_unfinished(place: &Place) {
    let mut folders = vec![place.root().to_owned()];
    folders.extend(place.results());
    folders.extend(Variant::ALL.map(|v| place.variants().join(v.name())));
    let of_cases: Vec<PathBuf> = folders.iter().flat_map(|folder| entries(folder)).collect();
    folders.iter().chain(&of_cases).for_each(|folder| aurt_files::output::clear_unfinished(folder));
}

/// What is in a folder; nothing if it cannot be read.
fn entries(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).map(|all| all.filter_map(Result::ok).map(|e| e.path()).collect());
    entries.unwrap_or_default()
}

/// Whether a folder holds a verdict, or why there is none.
fn is_done(folder: &Path) -> bool {
    [VERDICT, FAILED, UNFIT].iter().any(|file| folder.join(file).exists())
}

/// A variant of a case: its files while they are needed, and its verdict.
struct VariantCase {
    variant: Variant,
    files: PathBuf,
    verdict: PathBuf,
}

impl VariantCase {
    fn all(place: &Place, case: &str) -> Vec<Self> {
        let of = |variant: Variant| Self {
            variant,
            files: place.cases().join(format!("{case}_{}", variant.name())),
            verdict: place.variants().join(variant.name()).join(case),
        };
        Variant::ALL.map(of).into()
    }

    /// Diagnoses the variant of a case, whose verdict is in the folder `diagnosed`.
    fn prove(&self, case: &Path, diagnosed: &Path, options: &Options) -> Result<(), Failure> {
        if !is_done(&self.verdict) {
            let folder = self.verdict.parent().unwrap_or(&self.verdict);
            fs::create_dir_all(folder).map_err(|source| Failure::write(folder.to_owned(), source))?;
            match self.variant.files(case, band_hz(diagnosed))? {
                Ok(files) => {
                    OutputFolder::nested("--out", &self.files)?.write(&files)?;
                    diagnose(&self.files, &self.verdict, &[], options)?;
                }
                Err(reason) => OutputFolder::nested("--out", &self.verdict)?
                    .write(&[(UNFIT.to_owned(), reason.as_bytes().to_vec())])?,
            }
        }
        forget(&self.files, options)
    }
}

/// The band of a verdict, Hz; `None` of a program that states none.
fn band_hz(diagnosed: &Path) -> Option<f64> {
    let verdict: Value = serde_json::from_slice(&fs::read(diagnosed.join(VERDICT)).ok()?).ok()?;
    verdict["settings"]["f_dyn_hz"].as_f64()
}

fn prove_reference(source: &dyn Source, name: &str, place: &Place, options: &Options) -> Result<(), Failure> {
    let out = place.verdicts().join(reference_folder(name));
    let folder = place.references().join(name);
    if is_done(&out) {
        return forget(&folder, options);
    }
    let files: Vec<(String, Vec<u8>)> = source.reference(name)?.files;
    OutputFolder::nested("--out", &folder)?.write(&files)?;
    diagnose(&folder, &out, &[], options)?;
    forget(&folder, options)
}

fn prove_case(source: &dyn Source, index: usize, place: &Place, options: &Options) -> Result<(), Failure> {
    let name = Plan::case_name(index);
    let planned = &source.planned()[index];
    let folder = place.cases().join(&name);
    let verdict = place.verdicts().join(&name);
    let single = planned.effects.first().filter(|_| planned.case_type == CaseType::Single);
    let again: Vec<(PathBuf, [&str; 2])> =
        [(options.without, place.removed(), "--without"), (options.oracle, place.oracle(), "--only")]
            .into_iter()
            .filter(|(asked, ..)| *asked)
            .filter_map(|(_, out, option)| Some((out.join(&name), [option, single?])))
            .collect();
    let varied = if index < options.varied { VariantCase::all(place, &name) } else { Vec::new() };
    let unmade = place.unmade().join(format!("{name}.txt"));
    let mut verdicts = again.iter().map(|(folder, _)| folder).chain(varied.iter().map(|v| &v.verdict));
    if unmade.exists() || is_done(&verdict) && verdicts.all(|folder| is_done(folder)) {
        varied.iter().try_for_each(|v| forget(&v.files, options))?;
        return forget(&folder, options);
    }
    if let Err(reason) = make(source, index, &name, place)? {
        return OutputFolder::nested("--out", &place.unmade())?
            .write(&[(format!("{name}.txt"), reason.into_bytes())]);
    }
    if !is_done(&verdict) {
        diagnose(&folder, &verdict, &[], options)?;
    }
    for (out, arguments) in again.iter().filter(|(out, _)| !is_done(out)) {
        diagnose(&folder, out, arguments, options)?;
    }
    varied.iter().try_for_each(|v| v.prove(&folder, &verdict, options))?;
    forget(&folder, options)
}

/// Makes a case in a temporary folder and moves it there when it is complete; the reason if it cannot be made.
fn make(source: &dyn Source, index: usize, name: &str, place: &Place) -> Result<Result<(), String>, Failure> {
    let fail = |path: PathBuf| move |source| Failure::write(path, source);
    let building = aurt_files::output::StagedFolder::new(place.root())?;
    let (cases, sealed) = (building.path().join("cases"), building.path().join("sealed"));
    for folder in [&cases, &sealed] {
        // Not the folder that they are in, which an interruption may have removed.
        fs::create_dir(folder).map_err(fail(folder.clone()))?;
    }
    if let Err(error) = source.write(index, &cases, &sealed) {
        return Ok(Err(error.to_string()));
    }
    let file = format!("{name}.json");
    let truth = Truth::read(sealed.join(&file))?;
    let found = leaks(cases.join(name), &truth)?;
    if !found.is_empty() {
        return Ok(Err(format!("its folder gives the truth away: {}", found.join("; "))));
    }
    let moved = place.cases().join(name);
    remove(&moved)?;
    fs::rename(cases.join(name), &moved).map_err(fail(moved))?;
    let truth = place.sealed().join(&file);
    fs::rename(sealed.join(&file), &truth).map_err(fail(truth))?;
    Ok(Ok(()))
}

/// Removes the recordings of what has its verdict, unless they are to stay.
fn forget(folder: &Path, options: &Options) -> Result<(), Failure> {
    if options.keep { Ok(()) } else { remove(folder) }
}

fn remove(folder: &Path) -> Result<(), Failure> {
    match fs::remove_dir_all(folder) {
        Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
            Err(Failure::write(folder.to_owned(), source))
        }
        _ => Ok(()),
    }
}

/// Longest wait for a diagnosis that outlived a killed proof; it ends by itself, as all others do, after some seconds.
const OUTLIVES: Duration = Duration::from_secs(120);

/// Runs `aurt diagnose` in a case's folder. Nothing of the case is in the command but its folder. What it complained of,
/// if it failed, is written where its verdict would be.
fn diagnose(case: &Path, out: &Path, more: &[&str], options: &Options) -> Result<(), Failure> {
    let fail = |source| Failure::write(out.to_owned(), source);
    let out = std::path::absolute(out).map_err(fail)?;
    let mut command = Command::new(&options.program);
    command
        .args(["diagnose", "experiment.toml", "--quiet", "--verdict-only", "--out"])
        .arg(&out)
        .args(more)
        .current_dir(case)
        // Cases are diagnosed side by side.
        .env("RAYON_NUM_THREADS", "1")
        .envs([options.trust.environment()])
        .stdin(Stdio::null());
    let mut run = || {
        command.output().map_err(|error| {
            let reason = format!("{} cannot be run: {error}", options.program.display());
            Failure::argument("--program", reason, "name an executable of aurt")
        })
    };
    let (mut done, begin) = (run()?, Instant::now());
    while String::from_utf8_lossy(&done.stderr).contains("is in use: another run")
        && begin.elapsed() < OUTLIVES
    {
        std::thread::sleep(Duration::from_millis(200));
        done = run()?;
    }
    if out.join(VERDICT).exists() && matches!(done.status.code(), Some(0 | 1)) {
        return Ok(());
    }
    let said = String::from_utf8_lossy(&done.stderr).trim().to_owned();
    let reason = if said.is_empty() { format!("{} without a message", done.status) } else { said };
    OutputFolder::nested("--out", &out)?.write(&[(FAILED.to_owned(), reason.into_bytes())])
}

/// What could not be made or diagnosed: the case, and why.
pub fn complaints(place: &Place) -> Result<BTreeMap<String, String>, Failure> {
    let mut found = BTreeMap::new();
    let stem = |path: &Path| path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let read =
        |path: &Path| fs::read_to_string(path).map_err(|source| Failure::write(path.to_owned(), source));
    for path in entries(&place.unmade()) {
        found.insert(stem(&path), format!("could not be made: {}", read(&path)?));
    }
    let mut folders = vec![
        (place.removed(), " without its candidate".to_owned()),
        (place.oracle(), " with its candidate alone".to_owned()),
        (place.verdicts(), String::new()),
    ];
    folders.extend(Variant::ALL.map(|v| (place.variants().join(v.name()), format!(", {}", v.name()))));
    for (folder, what) in folders {
        for path in entries(&folder).iter().map(|p| p.join(FAILED)).filter(|p| p.exists()) {
            let case = path.parent().map(stem).unwrap_or_default();
            found.insert(format!("{case}{what}"), read(&path)?);
        }
    }
    Ok(found)
}
