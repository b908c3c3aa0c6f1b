//! `aurt-lab record`: one more recording of a concealed arm.

use std::path::PathBuf;

use crate::case::{Truth, World, servo};
use crate::commands::Report;
use crate::product::{Failure, OutputFile};
use clap::Args;
use serde_json::json;

/// Record a motion with the arm of a case of the world `servo`.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  aurt-lab record --truth sealed/case_0001.json --motion motion.csv --seed 1 --out added.csv"
)]
pub struct Record {
    /// The sealed truth of the case
    #[arg(long, value_name = "CASE.json")]
    truth: PathBuf,
    /// The motion: a table as `aurt next` and `aurt excite` write it
    #[arg(long, value_name = "MOTION.csv")]
    motion: PathBuf,
    /// Seed of the logger's noise
    #[arg(long, value_name = "N")]
    seed: u64,
    /// File for the recording
    #[arg(long, value_name = "FILE.csv")]
    out: PathBuf,
}

impl Record {
    pub fn run(&self) -> Result<Report, Failure> {
        let output = OutputFile::new("--out", &self.out, &[&self.truth, &self.motion])?;
        let truth = Truth::read(&self.truth)?;
        if truth.world != World::Servo {
            let reason = format!("is of the world `{}`", truth.world.name());
            return Err(Failure::unfit(&self.truth, reason, "name a truth of the world `servo`"));
        }
        output.write(&servo::record(&truth, &self.motion, self.seed)?)?;
        let text = format!("written: {}\n", output.path().display());
        Ok(Report { text, json: json!({ "command": "record", "outputs": [output.path()] }), findings: false })
    }
}
