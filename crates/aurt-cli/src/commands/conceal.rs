//! `aurt conceal`: recordings with physics that is known, and hidden.

use std::path::PathBuf;

use aurt_simulation::case::{Plan, conceal};
use clap::Args;
use serde_json::json;

use crate::{commands::Session, failure::Failure, rendering::terminal::Report};

/// Make cases for a proof: recordings of simulated robots with concealed physics, and the sealed truth.
///
/// Each case is a folder with an experiment, its geometry and recordings, and nothing else; the truth about it is
/// written elsewhere. The same plan and seed give the same bytes.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  aurt conceal --seed 7 --cases cases --sealed sealed\n  \
    aurt conceal --plan plan.toml --seed 7 --cases cases --sealed sealed")]
pub struct Conceal {
    /// Which cases to make; without it every effect once, two strangers, two pairs and four nulls
    #[arg(long, value_name = "PLAN.toml")]
    plan: Option<PathBuf>,
    /// Seed of everything that is drawn
    #[arg(long, value_name = "N")]
    seed: u64,
    /// Folder for the cases
    #[arg(long, value_name = "DIR")]
    cases: PathBuf,
    /// Folder for the truths
    #[arg(long, value_name = "DIR")]
    sealed: PathBuf,
}

impl Conceal {
    /// Conceals.
    pub fn run(&self, session: &Session<'_>) -> Result<Report, Failure> {
        let plan = self.plan.as_ref().map_or_else(|| Ok(Plan::small()), Plan::read)?;
        let count = plan.requests(self.seed)?.len();
        let progress = session.terminal.progress(count);
        let concealed = conceal(&plan, self.seed, &self.cases, &self.sealed, &|p| progress.step(p.last))?;
        drop(progress);
        Ok(Report {
            text: format!(
                "{} cases in {}, their truths in {}\n",
                concealed.truths.len(),
                self.cases.display(),
                self.sealed.display()
            ),
            json: json!({
                "command": "conceal",
                "seed": self.seed,
                "cases": concealed.truths.len(),
                "outputs": [self.cases, self.sealed],
            }),
            findings: false,
        })
    }
}
