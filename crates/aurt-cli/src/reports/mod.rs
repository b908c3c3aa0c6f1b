//! What commands found, as pages: `report.html`, and with `--plots` every figure as a file of its own.
//!
//! Pages are made from the structures that metrics.json and verdict.json are made from, and carry these documents.

pub mod calibration;
pub mod diagnosis;
pub mod figures;
pub mod parts;
pub mod recording;
pub mod sensitivity;
pub mod sweep;

use std::path::PathBuf;

use aurt_report::Page;
use clap::Args;

use crate::{failure::Failure, output::OutputFolder};

/// Name of a report in its folder.
pub const FILE: &str = "report.html";

/// Options of commands that write a report.
#[derive(Debug, Clone, Default, Args)]
pub struct PlotOptions {
    /// Folder for the report's figures, each as an SVG file; created if it does not exist
    #[arg(long, value_name = "DIR")]
    plots: Option<PathBuf>,
}

impl PlotOptions {
    /// No figures beside the report.
    pub const fn none() -> Self {
        Self { plots: None }
    }

    /// The folder, checked before any work is done.
    ///
    /// # Errors
    /// [`Failure::Output`].
    pub fn folder(&self) -> Result<Option<OutputFolder>, Failure> {
        self.plots.as_deref().map(|path| OutputFolder::nested("--plots", path)).transpose()
    }
}

/// Writes the figures of a page, if that was asked for, and says where they are.
///
/// # Errors
/// [`Failure::Write`].
pub fn write_plots(page: &Page, folder: Option<&OutputFolder>) -> Result<Vec<PathBuf>, Failure> {
    let Some(folder) = folder else { return Ok(Vec::new()) };
    let files: Vec<(String, Vec<u8>)> =
        page.figures().into_iter().map(|(name, figure)| (name, figure.to_svg().into_bytes())).collect();
    folder.write(&files)?;
    Ok(files.into_iter().map(|(name, _)| folder.path().join(name)).collect())
}
