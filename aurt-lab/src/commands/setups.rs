//! `aurt-lab setups`: how often `aurt check` accuses right setups, and tells wrong ones.

use std::path::PathBuf;

use crate::commands::{Report, Session};
use crate::product::{Failure, OutputFolder, pretty};
use crate::proof::program;
use crate::setups::{Counted, counted};
use clap::Args;
use serde_json::json;

/// Count false accusations over right setups, and told mistakes over wrong ones.
///
/// Setups are drawn: robots by name, of tables and of URDF files, currents with and without torque constants, one to five
/// recordings of excited, moved or slowly tracked motions, foreign units, noise, friction and loads that the experiment does
/// not state. A wrong setup has one usual mistake of a random joint or size. `aurt check` answers each.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  aurt-lab setups --right 600 --wrong 512 --seed 2 --out counted")]
pub struct Setups {
    /// Setups without a mistake
    #[arg(long, value_name = "N", default_value_t = 0)]
    right: usize,
    /// Setups with a mistake; kinds come in turn
    #[arg(long, value_name = "N", default_value_t = 0)]
    wrong: usize,
    /// Seed of all random numbers
    #[arg(long, value_name = "N")]
    seed: u64,
    /// Folder for the tables and every answer
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Keep the files of every setup in a folder of its name
    #[arg(long)]
    keep: bool,
    /// The executable of `aurt`; without it the one beside this program or in PATH
    #[arg(long, value_name = "FILE")]
    program: Option<PathBuf>,
}

impl Setups {
    pub fn run(&self, session: &Session) -> Result<Report, Failure> {
        let out = OutputFolder::new("--out", &self.out)?;
        let program = program(self.program.as_deref())?;
        std::fs::create_dir_all(out.path()).map_err(|source| Failure::write(out.path(), source))?;
        let progress = session.progress(self.right + self.wrong);
        let asked = Counted { right: self.right, wrong: self.wrong, seed: self.seed };
        let board = counted(asked, &program, out.path(), self.keep, &|name| progress.step(name))?;
        let text = board.markdown();
        let json = json!({ "command": "setups", "board": board });
        out.write(&[
            ("setups.md".into(), text.clone().into_bytes()),
            ("setups.json".into(), pretty(&json).into_bytes()),
        ])?;
        Ok(Report { text, json, findings: false })
    }
}
