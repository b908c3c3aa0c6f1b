//! `aurt-lab conceal`: recordings with physics that is known, and hidden.

use std::path::{Path, PathBuf};

use crate::case::{Plan, Truth, conceal};
use crate::commands::{Report, Session};
use crate::injected::InjectedWorld;
use crate::product::Failure;
use aurt_simulation::{Random, SimulationError};
use clap::Args;
use rayon::prelude::*;
use serde_json::json;

/// Make cases for a proof: recordings of simulated robots with concealed physics, and the sealed truth.
///
/// Each case is a folder with an experiment, its geometry and recordings, and nothing else; the truth about it is
/// written elsewhere. The same plan and seed give the same bytes.
///
/// With `--into`, the recordings are those of an experiment, real ones as a rule, and an effect's torque is added to
/// what they measured. The same recordings as they are lie in `references`, beside the folder of the cases.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  aurt-lab conceal --seed 7 --cases cases --sealed sealed\n  \
    aurt-lab conceal --plan plan.toml --seed 7 --cases cases --sealed sealed\n  \
    AURT_DATA=/path/to/recordings aurt-lab conceal --into examples/worlds/ur10e.toml --seed 7 --cases cases --sealed sealed")]
pub struct Conceal {
    /// Add effects to this experiment's recordings instead of simulating
    #[arg(long, value_name = "EXPERIMENT.toml")]
    into: Option<PathBuf>,
    /// Which cases to make; without it every effect once, unknown effects, two pairs and four nulls
    #[arg(long, value_name = "PLAN.toml")]
    plan: Option<PathBuf>,
    /// Seed of all random numbers
    #[arg(long, value_name = "N")]
    seed: u64,
    /// Folder for the cases
    #[arg(long, value_name = "DIR")]
    cases: PathBuf,
    /// Folder for the truths
    #[arg(long, value_name = "DIR")]
    sealed: PathBuf,
}

/// Reads a plan; what is wrong with it is said of its file.
pub fn read_plan(path: impl AsRef<Path>) -> Result<Plan, Failure> {
    let path = path.as_ref();
    Plan::read(path).map_err(|error| Failure::from(error).in_file(path))
}

impl Conceal {
    pub fn run(&self, session: &mut Session) -> Result<Report, Failure> {
        let plan = self.plan.as_ref().map_or_else(|| Ok(Plan::small()), read_plan)?;
        if let Some(experiment) = &self.into {
            return self.run_into(experiment, plan, session);
        }
        let progress = session.progress(plan.requests(self.seed)?.len());
        let count = conceal(&plan, self.seed, &self.cases, &self.sealed, &|case| progress.step(case))?;
        Ok(self.report(count, &[], None))
    }

    /// Adds effects to an experiment's recordings.
    fn run_into(&self, path: &Path, mut plan: Plan, session: &mut Session) -> Result<Report, Failure> {
        // The unknown effects of the small plan are the simulator's.
        if let (None, Some(unknown)) = (&self.plan, &mut plan.unknown_effects) {
            unknown.effects.clear();
        }
        let injection = InjectedWorld::read(path, &mut session.registry)?;
        let requests = injection.requests(&plan, self.seed)?;
        let references = self.references();
        for folder in [&self.cases, &self.sealed, &references] {
            std::fs::create_dir_all(folder).map_err(|source| Failure::write(folder.clone(), source))?;
        }
        for name in injection.references() {
            injection.reference(&name)?.write_folder(&references)?;
        }
        let progress = session.progress(requests.len());
        let made: Vec<Result<Truth, SimulationError>> = requests
            .par_iter()
            .enumerate()
            .map(|(index, request)| {
                let name = Plan::case_name(index);
                let seed = Random::labelled(self.seed, &format!("injected {index}")).bits();
                let case = injection.make(request, seed, &name)?;
                case.write(&self.cases, &self.sealed)?;
                progress.step(name);
                Ok(case.truth)
            })
            .collect();
        drop(progress);
        let mut refused: Vec<String> = injection.missing_nulls(&plan).into_iter().collect();
        let mut count = 0;
        for one in made {
            match one {
                Ok(_) => count += 1,
                // These recordings cannot have what was asked for; others of the plan they can.
                Err(SimulationError::Unreadable { path, reason }) => {
                    refused.push(format!("{}: {reason}", path.display()));
                }
                Err(other) => return Err(other.into()),
            }
        }
        Ok(self.report(count, &refused, Some(&references)))
    }

    /// The folder of the recordings as they are: beside that of the cases.
    fn references(&self) -> PathBuf {
        self.cases.parent().unwrap_or(Path::new("")).join("references")
    }

    fn report(&self, count: usize, refused: &[String], references: Option<&PathBuf>) -> Report {
        let mut text =
            format!("{count} cases in {}, their truths in {}\n", self.cases.display(), self.sealed.display());
        if let Some(folder) = references {
            text.push_str(&format!("the recordings as they are in {}\n", folder.display()));
        }
        for reason in refused {
            text.push_str(&format!("not made: {reason}\n"));
        }
        let mut outputs = vec![&self.cases, &self.sealed];
        outputs.extend(references);
        Report {
            text,
            json: json!({
                "command": "conceal",
                "seed": self.seed,
                "cases": count,
                "refused": refused,
                "outputs": outputs,
            }),
            findings: false,
        }
    }
}
