//! `aurt trust`: libraries whose code may run when an experiment names them.

use std::path::PathBuf;

use aurt_experiment::workbench::failure::Failure;
use aurt_plugins::Trust;
use clap::Args;
use serde_json::{Value, json};

use super::Session;
use crate::rendering::terminal::Report;

/// Trust model libraries that experiments name, or list trusted ones.
///
/// A library runs with your rights, and an experiment may come from someone else. Its bytes are trusted, not its name: a
/// library that is built again is another one.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  aurt trust target/release/libmy_friction.so\n  aurt trust")]
pub struct TrustLibraries {
    /// Libraries to trust from now on
    #[arg(value_name = "LIBRARY")]
    libraries: Vec<PathBuf>,
}

impl TrustLibraries {
    /// Adds to the list, or shows it.
    pub fn run(&self, _: &Session<'_>) -> Result<Report, Failure> {
        let list = Trust::list().ok_or_else(|| {
            Failure::argument(
                "trust",
                "there is no folder for the list: neither XDG_CONFIG_HOME nor HOME is set",
                "name a file in AURT_TRUST_FILE",
            )
        })?;
        let mut text = String::new();
        for library in &self.libraries {
            let hash = Trust::add(&list, library)?;
            text.push_str(&format!("trusted: {} (BLAKE3 {hash})\n", library.display()));
        }
        let listed = Trust::listed(&list)?;
        if self.libraries.is_empty() {
            text.push_str(&match listed.len() {
                0 => "no library is trusted\n".to_owned(),
                n => format!("{n} trusted, in {}\n", list.display()),
            });
            listed.iter().for_each(|(hash, file)| text.push_str(&format!("  {hash}  {file}\n")));
        }
        let entries: Vec<Value> =
            listed.iter().map(|(hash, file)| json!({ "blake3": hash, "library": file })).collect();
        let json = json!({ "command": "trust", "list": list, "trusted": entries });
        Ok(Report { text, json, findings: false })
    }
}
