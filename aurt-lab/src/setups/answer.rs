//! What `aurt check` says of a setup.

use std::path::Path;
use std::process::Command;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::Kind;
use super::mistakes::tells;
use super::setup::Setup;
use crate::product::{Failure, OutputFolder};

words! {
    /// Answer to a setup, in a word.
    Outcome {
        /// The mistake with its cure.
        Told = "told",
        /// Refused with exit status 2.
        Refused = "refused",
        /// Something is said to be wrong, but not what.
        Doubted = "doubted",
        /// Another mistake than what was made, or one where none was made.
        Accused = "accused",
        /// Nothing is said but what the motion leaves open.
        Silent = "silent",
    }
}

/// A setup and what was said of it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Answer {
    pub name: String,
    pub setup: String,
    /// The mistake that was made, with its joint or size.
    pub mistake: Option<[String; 2]>,
    pub outcome: Outcome,
    pub said: Vec<String>,
    /// Held-out error of the setup as it is.
    pub error: Option<f64>,
    /// What was compared, as `aurt check --json` gives it.
    pub compared: Value,
    /// Setups that were tried.
    pub trials: Option<u64>,
}

impl Answer {
    /// Writes a setup's files below `out`, asks, and forgets them unless `keep` is set.
    pub(super) fn ask(
        name: &str,
        setup: &Setup,
        kind: Option<&Kind>,
        program: &Path,
        out: &Path,
        keep: bool,
    ) -> Result<Self, Failure> {
        let staged = aurt_files::output::StagedFolder::new(out)?;
        let folder = if keep { out.join(name) } else { staged.path().join(name) };
        OutputFolder::nested("--out", &folder)?.write(&setup.files())?;
        // Setups are asked about side by side.
        let output = Command::new(program)
            .args(["check", "experiment.toml", "--json"])
            .current_dir(&folder)
            .env("RAYON_NUM_THREADS", "1")
            .output()
            .map_err(|source| Failure::write(program, source))?;
        let json: Value = serde_json::from_slice(&output.stdout).unwrap_or_default();
        let texts = |of: &Value, key: Option<&str>| -> Vec<String> {
            let text = |v: &Value| key.map_or(v, |key| &v[key]).as_str().map(str::to_owned);
            of.as_array().into_iter().flatten().filter_map(text).collect()
        };
        let (findings, mistakes) =
            (texts(&json["findings"], None), texts(&json["setup"]["mistakes"], Some("sentence")));
        let mut said = findings;
        said.extend(json["setup"]["doubt"].as_str().map(str::to_owned));
        if output.status.code() != Some(0) {
            said.push(
                String::from_utf8_lossy(&output.stderr).split_whitespace().collect::<Vec<_>>().join(" "),
            );
            said.extend(json["error"].as_str().map(str::to_owned));
            said.retain(|s| !s.is_empty());
        }
        let text = said.join(" ");
        let told = kind.is_some_and(|k| tells(&text, &k.cures));
        let outcome = match output.status.code() {
            _ if told => Outcome::Told,
            Some(1) if !mistakes.is_empty() => Outcome::Accused,
            Some(2) => Outcome::Refused,
            _ if json["setup"]["doubt"].is_string() => Outcome::Doubted,
            _ => Outcome::Silent,
        };
        Ok(Self {
            name: name.to_owned(),
            setup: setup.described.clone(),
            mistake: kind.map(|k| [k.name.to_owned(), k.detail.clone()]),
            outcome,
            said,
            error: json["setup"]["before"]["error"].as_f64(),
            compared: json["setup"]["compared"].clone(),
            trials: json["setup"]["trials"].as_u64(),
        })
    }
}
