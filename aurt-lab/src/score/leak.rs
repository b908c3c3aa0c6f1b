use std::path::Path;

use crate::case::Truth;
use aurt_simulation::SimulationError;

/// Words that stand in a sealed truth and in no experiment.
const SEALED: [&str; 7] =
    ["case_type", "achieved", "in_vocabulary", "noise_nm", "floor_nm", "strength", "conceal"];

/// Identifiers that experiments have as keys of their own, whatever is in the recordings.
const KEYS: [&str; 3] = ["coulomb", "viscous", "rotor_inertia"];

/// Keys of experiments that contain an identifier; any experiment of a robot whose measurement is a current has them.
const CONTAINING: [&str; 1] = ["torque_constants_nm_per_a ="];

/// What a case's folder gives away of the truth: files that a diagnosis has no use for, words of the sealed truth,
/// names of the effects, the seed. Recordings may hold numbers only, below one line of column names.
pub fn leaks(folder: impl AsRef<Path>, truth: &Truth) -> Result<Vec<String>, SimulationError> {
    let folder = folder.as_ref();
    let io = |source| SimulationError::Io { path: folder.into(), source };
    let mut found = Vec::new();
    let mut entries = std::fs::read_dir(folder).map_err(io)?.collect::<Result<Vec<_>, _>>().map_err(io)?;
    entries.sort_by_key(std::fs::DirEntry::file_name);
    for entry in entries {
        let name = entry.file_name().to_string_lossy().into_owned();
        if !entry.path().is_file() || !is_expected(&name) {
            found.push(format!("{name} is no file of a case"));
            continue;
        }
        let text = std::fs::read(entry.path())
            .map_err(|source| SimulationError::Io { path: entry.path(), source })?;
        let text = String::from_utf8_lossy(&text).to_lowercase();
        if name.starts_with("recording_")
            && let Some(line) = text.lines().skip(1).find(|line| is_text(line))
        {
            found.push(format!("{name} holds text: {line}"));
        }
        let mut head: String =
            if name.starts_with("recording_") { text.lines().take(1).collect() } else { text };
        if name == "experiment.toml" {
            CONTAINING.iter().for_each(|key| head = head.replace(key, "="));
        }
        found.extend(
            words(truth)
                .into_iter()
                .filter(|w| head.contains(w.as_str()))
                .map(|w| format!("{name} says `{w}`")),
        );
    }
    Ok(found)
}

/// Whether a line holds more than numbers. Corrupt rows hold NaN or infinity, which are no words.
fn is_text(line: &str) -> bool {
    let is_number = |text: &str| text.bytes().all(|b| b.is_ascii_digit() || b"+-.,;e \t\r".contains(&b));
    !is_number(line) && !is_number(&line.replace("nan", "").replace("infinity", "").replace("inf", ""))
}

fn is_expected(name: &str) -> bool {
    let recording = name.strip_prefix("recording_").and_then(|n| n.strip_suffix(".csv"));
    matches!(name, "experiment.toml" | "mdh.csv" | "robot.urdf")
        || recording.is_some_and(|n| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit()))
}

fn words(truth: &Truth) -> Vec<String> {
    let effects = truth.effects.iter().chain(&truth.background).map(|e| e.effect.as_str());
    let mut words: Vec<String> = effects.filter(|e| !KEYS.contains(e)).map(str::to_lowercase).collect();
    words.extend(SEALED.iter().map(|w| (*w).to_owned()));
    words.push(truth.seed.to_string());
    // A seed of a few digits is any number.
    words.retain(|w| w.len() > 5);
    words.sort();
    words.dedup();
    words
}
