//! Every kind of input × every damage: a refusal with place and remedy or a right result; never a panic, a hang, a
//! partial result, or memory beyond twenty times the input and 200 MB.
//!
//! `cargo test --test faults` does a share of it; `AURT_FAULTS=all cargo test --release --test faults -- --nocapture` does
//! all of it and prints its counts.

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use crate::bench::Bench;
use crate::damages::{self, Damage, Draws};
use crate::subject::{INPUTS, Input, program};

/// Longest time that a command may take here.
const LONGEST: Duration = Duration::from_secs(300);
/// Memory that a command may take: so many times its input, and so many bytes.
const MEMORY: (u64, u64) = (20, 200 << 20);
/// Draws of each damage that draws something, in all and in the share of every test run.
const DRAWS: (usize, usize) = (12, 1);

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Outcome {
    Refused,
    Result,
    Findings,
}

/// Runs a case in a folder of its own; what is wrong with what came out.
fn run(bench: &Bench, input: Input, damage: Damage, seed: u64) -> Result<Outcome, String> {
    let folder = bench.copy();
    let path = folder.path().join(input.file);
    let mut draws = Draws(seed);
    let mut named = input.file.to_owned();
    let command_line = input.command;
    match damage {
        Damage::None => {}
        Damage::Missing => fs::remove_file(&path).unwrap(),
        Damage::Folder => {
            fs::remove_file(&path).unwrap();
            fs::create_dir(&path).unwrap();
        }
        Damage::Device => {
            fs::remove_file(&path).unwrap();
            symlink("/dev/zero", &path).unwrap();
        }
        Damage::Pipe => {
            fs::remove_file(&path).unwrap();
            assert!(Command::new("mkfifo").arg(&path).status().unwrap().success());
        }
        Damage::Name(name) => {
            // Only commands that are given the name can be given another.
            if !command_line.contains("FILE") {
                return Ok(Outcome::Result);
            }
            named = format!("{name}-{}", input.file);
            fs::rename(&path, folder.path().join(&named)).unwrap();
        }
        _ => {
            let bytes = fs::read(&path).unwrap();
            fs::write(&path, damage.of(&bytes, &mut draws).unwrap()).unwrap();
        }
    }
    if named.starts_with('-') {
        named = format!("./{named}");
    }
    let arguments: Vec<String> = command_line
        .split(' ')
        .map(|word| if word == "FILE" { named.clone() } else { word.to_owned() })
        .collect();
    let size = folder_size(folder.path());
    let before = names(folder.path());
    let out = fs::File::create(folder.path().join(".stdout")).unwrap();
    let err = fs::File::create(folder.path().join(".stderr")).unwrap();
    let mut child = Command::new(program())
        .args(&arguments)
        .current_dir(folder.path())
        .env("RAYON_NUM_THREADS", "2")
        .stdin(Stdio::null())
        .stdout(out)
        .stderr(err)
        .spawn()
        .unwrap();
    let begin = Instant::now();
    let mut memory = 0;
    let status = loop {
        memory = memory.max(peak_memory(child.id()));
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        if begin.elapsed() > LONGEST {
            child.kill().unwrap();
            child.wait().unwrap();
            return Err(format!("not done after {LONGEST:?}"));
        }
        std::thread::sleep(Duration::from_millis(3));
    };
    let said = String::from_utf8_lossy(&fs::read(folder.path().join(".stderr")).unwrap()).into_owned();
    let allowed = MEMORY.0 * size + MEMORY.1;
    if memory > allowed {
        return Err(format!("{} MB of memory, {} MB allowed", memory >> 20, allowed >> 20));
    }
    if said.contains("panicked") || said.contains('\u{1b}') {
        return Err(format!("status {status}: {said}"));
    }
    if said.len() > 200_000 {
        return Err(format!("{} bytes are said", said.len()));
    }
    let Some(code) = status.code() else { return Err(format!("{status}: {said}")) };
    let left: Vec<String> =
        names(folder.path()).into_iter().filter(|n| !before.contains(n) && !n.starts_with(".std")).collect();
    if let Some(stray) = left.iter().find(|n| n.contains(".part")) {
        return Err(format!("{stray} is left behind"));
    }
    match code {
        0 | 1 => {
            check_results(folder.path())?;
            Ok(if code == 0 { Outcome::Result } else { Outcome::Findings })
        }
        2 if damage == Damage::None && input.file != "library.so" => {
            Err(format!("an undamaged input is refused: {said}"))
        }
        2 => {
            // A damaged file may make another one wrong, and a folder that is no sweep's any more is named itself.
            let stems = "mdh a.csv b.csv experiment sweep scenario plan limits model library log.";
            let place = stems.split(' ').any(|stem| said.contains(stem));
            if !place {
                return Err(format!("the refusal names no place: {said}"));
            }
            // A sweep that is planned leaves its lock.
            match left.iter().find(|n| *n == "out" && !input.command.starts_with("sweep")) {
                Some(partial) => Err(format!("{partial} is left after a refusal: {said}")),
                None => Ok(Outcome::Refused),
            }
        }
        other => Err(format!("status {other}: {said}")),
    }
}

/// Tables that were written hold numbers only.
fn check_results(folder: &Path) -> Result<(), String> {
    let none = |cell: &str| ["nan", "inf", "-inf"].contains(&cell.trim().to_lowercase().as_str());
    let mut tables: Vec<_> =
        fs::read_dir(folder.join("out")).into_iter().flatten().flatten().map(|e| e.path()).collect();
    tables.push(folder.join("out"));
    for path in tables.into_iter().filter(|p| p.is_file()) {
        let text = String::from_utf8_lossy(&fs::read(&path).unwrap()).into_owned();
        let is_table = path.extension().is_none_or(|e| e == "csv");
        if is_table && text.lines().any(|line| line.split(',').any(none)) {
            return Err(format!("{} holds values that are no numbers", path.display()));
        }
    }
    Ok(())
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect()
}

fn folder_size(folder: &Path) -> u64 {
    let entries = fs::read_dir(folder).unwrap().flatten().map(|entry| entry.path());
    let size = |path: std::path::PathBuf| match fs::symlink_metadata(&path) {
        Ok(found) if found.is_dir() => folder_size(&path),
        Ok(found) if found.is_file() => found.len(),
        _ => 0,
    };
    entries.map(size).sum()
}

/// Largest resident memory of a process so far; zero where the system does not tell.
fn peak_memory(process: u32) -> u64 {
    let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kilobytes = line.and_then(|rest| rest.trim().split(' ').next()?.parse::<u64>().ok());
    kilobytes.unwrap_or(0) << 10
}

#[test]
fn every_input_stands_every_damage() {
    let whole = std::env::var_os("AURT_FAULTS").is_some_and(|v| v == "all");
    let bench = Bench::new();
    let list = damages::all(if whole { DRAWS.0 } else { DRAWS.1 });
    let mut cases: Vec<(Input, Damage, u64)> = Vec::new();
    for (i, input) in INPUTS.iter().enumerate() {
        for (k, damage) in list.iter().enumerate() {
            let costly = matches!(damage, Damage::LongLine(50_000_000) | Damage::Pipe);
            // A share of the costly and of the drawn ones; every input and every damage has its turn.
            let turn = (i + k) % if costly { 13 } else { 2 } == 0;
            if whole || turn || *damage == Damage::None {
                cases.push((*input, *damage, (1000 * i + k) as u64));
            }
        }
    }
    let next = AtomicUsize::new(0);
    let counts: Mutex<BTreeMap<Outcome, usize>> = Mutex::default();
    let failures: Mutex<Vec<String>> = Mutex::default();
    let workers = std::thread::available_parallelism().map_or(2, usize::from);
    let begin = Instant::now();
    std::thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                while let Some((input, damage, seed)) = cases.get(next.fetch_add(1, Ordering::Relaxed)) {
                    match run(&bench, *input, *damage, *seed) {
                        Ok(outcome) => *counts.lock().unwrap().entry(outcome).or_default() += 1,
                        Err(what) => {
                            let what: String = what.chars().take(1500).collect();
                            let case = format!("{} with {damage:?} (seed {seed}): {what}", input.command);
                            failures.lock().unwrap().push(case.replace("FILE", input.file));
                        }
                    }
                }
            });
        }
    });
    println!(
        "{} cases ({} inputs, {} damages) in {:.0} s: {:?}",
        cases.len(),
        INPUTS.len(),
        list.len(),
        begin.elapsed().as_secs_f64(),
        counts.into_inner().unwrap()
    );
    let failures = failures.into_inner().unwrap();
    assert!(failures.is_empty(), "{} of {} cases:\n{}", failures.len(), cases.len(), failures.join("\n\n"));
}
