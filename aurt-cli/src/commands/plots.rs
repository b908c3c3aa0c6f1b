//! `--plots`, an option of every command that writes a report.

use std::path::PathBuf;

use aurt_experiment::workbench::failure::Failure;
use aurt_experiment::workbench::output::OutputFolder;
use clap::Args;

/// Options of commands that write a report.
#[derive(Debug, Clone, Default, Args)]
pub struct PlotOptions {
    /// Folder for the report's figures, each as an SVG file; created if it does not exist
    #[arg(long, value_name = "DIR")]
    plots: Option<PathBuf>,
}

impl PlotOptions {
    /// The folder, checked before any work is done.
    pub fn folder(&self) -> Result<Option<OutputFolder>, Failure> {
        self.plots.as_deref().map(|path| OutputFolder::nested("--plots", path)).transpose()
    }
}
