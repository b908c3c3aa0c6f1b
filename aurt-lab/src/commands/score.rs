//! `aurt-lab score`: what diagnoses said of concealed cases, compared with the truth.

use std::path::PathBuf;

use crate::commands::Report;
use crate::product::{Failure, OutputFile, pretty};
use crate::proof::{Verdicts, add_oracle, read_scores};
use crate::score::Scoreboard;
use clap::Args;
use serde_json::json;

/// Compare verdicts on concealed cases with the sealed truth.
///
/// Verdicts are files DIR/CASE/verdict.json, as `aurt diagnose --out DIR/CASE` writes them; any other tool may have
/// written them. Cases of real recordings need DIR/reference_NAME/verdict.json as well, the verdict on the recordings as
/// they are: what is claimed of these is no news.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  aurt-lab conceal --seed 7 --cases cases --sealed sealed\n  \
    for c in cases/*; do aurt diagnose $c/experiment.toml --out verdicts/$(basename $c); done\n  \
    aurt-lab score --sealed sealed --verdicts verdicts")]
pub struct Score {
    /// Folder with the truths
    #[arg(long, value_name = "DIR")]
    sealed: PathBuf,
    /// Folder with a folder for each case
    #[arg(long, value_name = "DIR")]
    verdicts: PathBuf,
    /// Folder with verdicts of diagnoses that examined each single's effect alone (`aurt diagnose --only EFFECT`)
    #[arg(long, value_name = "DIR")]
    oracle: Option<PathBuf>,
    /// File for the scoreboard and every case's score, as JSON
    #[arg(long, value_name = "FILE.json")]
    out: Option<PathBuf>,
}

impl Score {
    pub fn run(&self) -> Result<Report, Failure> {
        let output = self.out.as_ref().map(|path| OutputFile::new("--out", path, &[])).transpose()?;
        let mut scores = read_scores(&self.sealed, &self.verdicts, &Verdicts::Own)?;
        if let Some(oracle) = &self.oracle {
            add_oracle(&mut scores, &self.sealed, &self.verdicts, oracle)?;
        }
        let board = Scoreboard::of(&scores);
        let text = format!("{} verdicts\n\n{}", scores.len(), board.markdown());
        let json = json!({ "command": "score", "board": board, "cases": scores });
        if let Some(output) = output {
            output.write(pretty(&json).as_bytes())?;
        }
        Ok(Report { text, json, findings: false })
    }
}
