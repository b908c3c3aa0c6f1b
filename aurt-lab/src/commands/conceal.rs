//! `aurt-lab conceal`: recordings with physics that is known, and hidden.

use std::path::{Path, PathBuf};

use crate::case::{Plan, World};
use crate::commands::{Report, Session};
use crate::product::Failure;
use crate::proof::{self, Ingredients, Place};
use aurt_simulation::SimulationError;
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
    /// World to make cases of: clean, rough, mujoco or servo
    #[arg(long, default_value = "clean", value_parser = world, conflicts_with = "into")]
    world: World,
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

pub(super) fn world(name: &str) -> Result<World, String> {
    World::named(name).ok_or_else(|| {
        let known: Vec<&str> = World::ALL.iter().map(|w| w.name()).collect();
        format!("it is not a world; known are {}", known.join(", "))
    })
}

/// Reads a plan, or makes the small one of a world; what is wrong with a plan is said of its file.
pub(super) fn read_plan(path: Option<&Path>, world: World) -> Result<Plan, Failure> {
    if let Some(path) = path {
        return Plan::read(path).map_err(|error| Failure::from(error).in_file(path));
    }
    let mut plan = Plan::small();
    // The unknown effects of the plan are our own simulator's; others have theirs.
    if let (World::Mujoco | World::Injected | World::Servo, Some(unknown)) =
        (world, &mut plan.unknown_effects)
    {
        unknown.effects.clear();
    }
    Ok(plan)
}

impl Conceal {
    pub fn run(&self, session: &mut Session) -> Result<Report, Failure> {
        let world = if self.into.is_some() { World::Injected } else { self.world };
        let plan = read_plan(self.plan.as_deref(), world)?;
        let ingredients = Ingredients { plan, seed: self.seed, into: self.into.iter().cloned().collect() };
        let beside = self.cases.parent().unwrap_or(Path::new(""));
        let source = proof::source(world, &ingredients, &Place::new(beside, world), &mut session.registry)?
            .map_err(|reason| Failure::argument("--world", reason, "make cases of another world"))?;
        let names = source.references();
        // The recordings as they are lie beside the folder of the cases.
        let references = (!names.is_empty()).then(|| beside.join("references"));
        for folder in [&self.cases, &self.sealed].into_iter().chain(&references) {
            std::fs::create_dir_all(folder).map_err(|source| Failure::write(folder.clone(), source))?;
        }
        for (name, folder) in names.iter().zip(references.iter().cycle()) {
            source.reference(name)?.write_folder(folder)?;
        }
        let cases = source.planned().len();
        let progress = session.progress(cases);
        let made: Vec<Result<(), SimulationError>> = (0..cases)
            .into_par_iter()
            .map(|index| {
                source.write(index, &self.cases, &self.sealed)?;
                progress.step(Plan::case_name(index));
                Ok(())
            })
            .collect();
        drop(progress);
        let mut refused = source.remarks().to_vec();
        for one in made {
            match one {
                // This world cannot have what was asked for; others of the plan it can.
                Err(error @ SimulationError::Unreadable { .. }) => refused.push(error.to_string()),
                other => other?,
            }
        }
        let count = cases + source.remarks().len() - refused.len();
        Ok(self.report(count, &refused, references.as_ref()))
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
