//! Commands that are ended at random moments: their results are whole or absent, and what goes on goes on to the same.

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::bench::Bench;
use crate::damages::Draws;
use crate::subject::{COMMANDS, PREPARATIONS, aurt, program};

const CASES: &str = "[recordings]\n[nulls]\nrobots = [\"two_link\"]\ncount = 2\n";
const PROOF: &str =
    "[recordings]\nduration_s = 8.0\nrate_hz = 125.0\n[nulls]\nrobots = [\"two_link\"]\ncount = 2\n";
const SIGNALS: [&str; 3] = ["INT", "TERM", "KILL"];
/// Interruptions of each command by each signal, in all and in the share of every test run.
const MOMENTS: (usize, usize) = (24, 1);
/// Longest time from a signal to the end, or half of what the whole command takes on a machine that may be busy.
const ANSWER: Duration = Duration::from_secs(2);

/// Whether a command came to its end; 1 says that a diagnosis found something.
fn is_done(status: std::process::ExitStatus) -> bool {
    matches!(status.code(), Some(0 | 1))
}

fn start(program: &Path, folder: &Path, line: &str) -> std::process::Child {
    Command::new(program)
        .args(line.split(' '))
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

/// Every file below `out` and `sealed`, but for locks, what is being written and the cases that a proof works on.
fn results(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut places = vec![folder.join("out"), folder.join("sealed")];
    while let Some(place) = places.pop() {
        if is_part(&place) || is_named(&place, &["cases", "references", "lock"]) {
            continue;
        }
        if place.is_dir() {
            places.extend(fs::read_dir(&place).unwrap().map(|e| e.unwrap().path()));
        } else if place.is_file() {
            let name = place.strip_prefix(folder).unwrap().to_owned();
            found.insert(name, fs::read(&place).unwrap());
        }
    }
    found
}

fn is_part(path: &Path) -> bool {
    let part = |name: &str| name.starts_with(".aurt-");
    path.iter().any(|name| name.to_str().is_some_and(part))
}

fn is_named(path: &Path, names: &[&str]) -> bool {
    names.iter().any(|name| path.file_name().is_some_and(|of| of == *name))
}

/// What is being written, but for the verdicts of a proof: its diagnoses are processes that end by themselves.
fn parts(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut places = vec![folder.to_owned()];
    while let Some(place) = places.pop() {
        for entry in fs::read_dir(&place).unwrap() {
            let path = entry.unwrap().path();
            if is_part(&path) {
                found.push(path);
            } else if path.is_dir() && !is_named(&path, &["verdicts"]) {
                places.push(path);
            }
        }
    }
    found
}

/// Times are part of a report; everything else of a result is the same every time.
fn same(name: &Path, a: &[u8], b: &[u8]) -> bool {
    name.extension().is_some_and(|e| e == "html") || a == b
}

#[test]
fn what_is_interrupted_is_whole_or_absent() {
    let whole = std::env::var_os("AURT_FAULTS").is_some_and(|v| v == "all");
    let moments = if whole { MOMENTS.0 } else { MOMENTS.1 };
    let bench = Bench::new();
    fs::write(bench.path().join("cases.toml"), CASES).unwrap();
    fs::write(bench.path().join("proof.toml"), PROOF).unwrap();
    for line in PREPARATIONS {
        assert!(start(aurt(), bench.path(), line).wait().unwrap().success(), "{line}");
    }
    let mut draws = Draws(20_261_120);
    let (mut ended, mut done, mut slowest) = (0, 0, Duration::ZERO);
    for (line, resumes) in COMMANDS.iter().copied() {
        // Sweeps know where they are, so everything happens in one folder.
        let folder = bench.copy();
        let begin = Instant::now();
        assert!(is_done(start(program(), folder.path(), line).wait().unwrap()), "{line}");
        let takes_ms = begin.elapsed().as_millis() as usize + 1;
        let expected = results(folder.path());
        assert!(!expected.is_empty(), "{line}");
        for signal in SIGNALS {
            for _ in 0..moments {
                for place in ["out", "sealed"].map(|name| folder.path().join(name)) {
                    let _ = if place.is_dir() { fs::remove_dir_all(place) } else { fs::remove_file(place) };
                }
                for part in parts(folder.path()) {
                    let _ = if part.is_dir() { fs::remove_dir_all(part) } else { fs::remove_file(part) };
                }
                let mut child = start(program(), folder.path(), line);
                std::thread::sleep(Duration::from_millis(draws.below(takes_ms) as u64));
                let sent = Instant::now();
                let told = Command::new("kill")
                    .args(["-s", signal, &child.id().to_string()])
                    .stderr(Stdio::null())
                    .status()
                    .unwrap();
                let status = child.wait().unwrap();
                let answer = sent.elapsed();
                let was_ended = status.code() == Some(130) || status.signal().is_some();
                if !was_ended {
                    assert!(is_done(status), "{line}: {status}");
                    done += 1;
                    continue;
                }
                assert!(told.success());
                ended += 1;
                slowest = slowest.max(answer);
                let longest = ANSWER.max(Duration::from_millis(takes_ms as u64 / 2));
                assert!(answer < longest, "{line}, {signal}: {answer:?}");
                let kept = results(folder.path());
                for (name, bytes) in &kept {
                    let right = expected.get(name).is_some_and(|right| same(name, bytes, right));
                    assert!(right, "{line}, {signal}: {} is not what it would have been", name.display());
                }
                if signal != "KILL" && status.signal().is_none() {
                    assert_eq!(parts(folder.path()), Vec::<PathBuf>::new(), "{line}, {signal}");
                    let all_or_none = kept.is_empty() || kept.len() == expected.len();
                    assert!(resumes || all_or_none, "{line}, {signal}: {:?}", kept.keys());
                }
                if resumes || signal == "KILL" {
                    assert!(is_done(start(program(), folder.path(), line).wait().unwrap()), "{line} again");
                    assert_eq!(parts(folder.path()), Vec::<PathBuf>::new(), "{line}, {signal}, again");
                    let again = results(folder.path());
                    assert!(again.keys().eq(expected.keys()), "{line}: {:?}", again.keys());
                    let equal = again.iter().all(|(name, bytes)| same(name, bytes, &expected[name]));
                    assert!(equal, "{line}: what went on differs");
                }
            }
        }
    }
    println!(
        "{ended} interruptions, {done} commands that were done before; the slowest answer took {slowest:?}"
    );
    assert!(ended > 0);
}
