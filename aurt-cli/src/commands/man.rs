//! `aurt man`: manual pages.

use std::path::PathBuf;

use aurt_experiment::workbench::failure::Failure;
use aurt_experiment::workbench::output::OutputFolder;
use clap::Args;
use clap_mangen::Man as Page;
use serde_json::json;

use super::Session;
use super::run::written_text;
use crate::rendering::terminal::Report;

/// Write manual pages, one for aurt and one for each command.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  aurt man --out ~/.local/share/man/man1")]
pub struct Man {
    /// Folder for the pages; created if it does not exist
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

impl Man {
    pub fn run(&self, session: &Session<'_>) -> Result<Report, Failure> {
        let folder = OutputFolder::new("--out", &self.out)?;
        let mut command = (session.definition)();
        command.build();
        let mut files = vec![page("aurt", &command, folder.path())?];
        for subcommand in command.get_subcommands().filter(|c| c.get_name() != "help") {
            files.push(page(&format!("aurt-{}", subcommand.get_name()), subcommand, folder.path())?);
        }
        folder.write(&files)?;
        let written: Vec<PathBuf> = files.iter().map(|(name, _)| folder.path().join(name)).collect();
        Ok(Report {
            text: written_text(&written).trim_start().to_owned(),
            json: json!({ "command": "man", "outputs": written }),
            findings: false,
        })
    }
}

fn page(name: &str, command: &clap::Command, folder: &std::path::Path) -> Result<(String, Vec<u8>), Failure> {
    let file = format!("{name}.1");
    let mut contents = Vec::new();
    Page::new(command.clone())
        .render(&mut contents)
        .map_err(|source| Failure::write(folder.join(&file), source))?;
    Ok((file, contents))
}
