//! `aurt completions`: what a shell needs to complete command lines.

use aurt_experiment::workbench::failure::Failure;
use clap::Args;
use clap_complete::{Shell, generate};
use serde_json::json;

use super::Session;
use crate::rendering::terminal::Report;

/// Print a script that lets your shell complete aurt's command lines.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  aurt completions bash > ~/.local/share/bash-completion/completions/aurt\n  \
    aurt completions fish > ~/.config/fish/completions/aurt.fish"
)]
pub struct Completions {
    /// The shell
    #[arg(value_enum, value_name = "SHELL")]
    shell: Shell,
}

impl Completions {
    /// Makes the script.
    pub fn run(&self, session: &Session<'_>) -> Result<Report, Failure> {
        let mut script = Vec::new();
        generate(self.shell, &mut (session.definition)(), "aurt", &mut script);
        let text = String::from_utf8_lossy(&script).into_owned();
        let json = json!({ "command": "completions", "shell": self.shell.to_string(), "script": text });
        Ok(Report { text, json, findings: false })
    }
}
