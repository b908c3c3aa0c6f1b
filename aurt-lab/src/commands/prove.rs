//! `aurt-lab prove`: how often a diagnosis is right, on cases whose truth is known and hidden from it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::case::{Plan, World};
use crate::commands::conceal::{read_plan, world};
use crate::commands::{Report, Session};
use crate::product::{Failure, OutputFolder, pretty};
use crate::proof::{self, Ingredients, Options, Place, Proof, Proven, Shard};
use clap::Args;
use serde_json::json;

/// Count how often a diagnosis is right: conceal effects, diagnose each case in a process of its own that sees
/// nothing but the case's folder, score.
///
/// Cases come from worlds that differ in what differs between laboratories, and every table has a column for each: `clean`
/// and `rough` are our own simulator, `mujoco` is another engine (Python with `mujoco`; AURT_PYTHON names the interpreter),
/// `injected` adds effects to the recordings of experiments that `--into` names, `servo` are simulated servo arms that
/// record commands and positions. A world that cannot be made here is
/// skipped with a line that says why. Every case of one effect is diagnosed once more with that effect's candidate
/// removed. Cases that were diagnosed before are skipped: a proof that was
/// interrupted goes on.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  aurt-lab prove --small --seed 7 --out proof\n  \
    aurt-lab prove --plan examples/proof/full.toml --seed 20261120 --shard 3/8 --out part3\n  \
    aurt-lab prove --collect part1 part2 part3 --out proof\n  \
    aurt-lab prove --learn learnt.json --proof proof")]
pub struct Prove {
    /// World to make cases of: clean, rough, mujoco, injected or servo; may be given several times
    #[arg(long, value_name = "WORLD", value_parser = world, default_values = ["clean", "rough"])]
    world: Vec<World>,
    /// Which cases to make; without it every effect once, two unknown effects, two pairs and four nulls
    #[arg(long, value_name = "PLAN.toml")]
    plan: Option<PathBuf>,
    /// A handful of cases of each world, in some minutes
    #[arg(long, conflicts_with = "plan")]
    small: bool,
    /// Seed of all random numbers
    #[arg(long, value_name = "N", required_unless_present_any = ["collect", "proofs", "so_far"])]
    seed: Option<u64>,
    /// Folder for truths, verdicts and the scoreboard, world by world; created if it does not exist
    #[arg(long, value_name = "DIR", required_unless_present = "proofs")]
    out: Option<PathBuf>,
    /// Experiment to whose recordings effects are added, for the world injected; may be given several times
    #[arg(long, value_name = "EXPERIMENT.toml")]
    into: Vec<PathBuf>,
    /// Make a part of the cases alone, such as the third of eight
    #[arg(long, value_name = "3/8", value_parser = |text: &str| text.parse::<Shard>())]
    shard: Option<Shard>,
    /// Put the parts of a proof together in --out, and diagnose no further cases
    #[arg(long, value_name = "DIR", num_args = 1.., conflicts_with_all = ["shard", "plan", "small", "seed"])]
    collect: Vec<PathBuf>,
    /// Executable of aurt that diagnoses; without it the one in the folder of this program, else in PATH
    #[arg(long, value_name = "PATH")]
    program: Option<PathBuf>,
    /// Keep the recordings of the cases (some 15 MB each); without it those of diagnosed cases go
    #[arg(long)]
    keep: bool,
    /// Do not diagnose cases once more with their candidate removed
    #[arg(long)]
    no_removal: bool,
    /// Diagnose every single once more with its effect's candidate alone: what that does not see is not in the data
    #[arg(long)]
    oracle: bool,
    /// Diagnose cases (all, or this number of each world) once more in variants of the same robot: half and twice f_dyn_hz,
    /// another order of the recordings, half the rate, degrees, and each half of the reference
    #[arg(long, value_name = "CASES", num_args = 0..=1)]
    invariance: Option<Option<usize>>,
    /// Write the scoreboard of what has been diagnosed so far, and diagnose no further cases
    #[arg(long)]
    so_far: bool,
    /// Write what confidence is made of, for `aurt diagnose --learnt`: how often findings were right, by their evidence
    #[arg(long, value_name = "FILE.json")]
    learn: Option<PathBuf>,
    /// Learn from this finished proof instead of making one; may be given several times
    #[arg(long = "proof", value_name = "DIR", requires = "learn", conflicts_with = "out")]
    proofs: Vec<PathBuf>,
}

impl Prove {
    pub fn run(&self, session: &mut Session) -> Result<Report, Failure> {
        let Some(out) = &self.out else { return self.learn_from_proofs() };
        let folder = OutputFolder::new("--out", out)?;
        let mut skipped = BTreeMap::new();
        if !self.collect.is_empty() {
            proof::collect(&self.collect, out)?;
        } else if let Some(seed) = self.seed.filter(|_| !self.so_far) {
            folder.write(&[])?;
            skipped = self.prove(seed, out, session)?;
        }
        let Proven { mut text, mut json, is_incomplete, scores } = proof::report(out, &skipped)?;
        if let Some(path) = &self.learn {
            json["learnt"] = json!(proof::learn(path, &scores)?);
            text.push_str(&format!("\nlearnt from these cases: {}\n", path.display()));
        }
        folder.write(&[
            ("scoreboard.json".to_owned(), pretty(&json).into_bytes()),
            ("scoreboard.md".to_owned(), text.clone().into_bytes()),
        ])?;
        Ok(Report { text, json, findings: is_incomplete })
    }

    /// Makes and diagnoses the cases of all worlds; the worlds that cannot be made here, and why.
    fn prove(
        &self,
        seed: u64,
        out: &Path,
        session: &mut Session,
    ) -> Result<BTreeMap<World, String>, Failure> {
        let mut skipped = BTreeMap::new();
        let shard = self.shard.unwrap_or_default();
        let program = proof::program(self.program.as_deref())?;
        for world in World::ALL.into_iter().filter(|w| self.world.contains(w)) {
            let place = Place::new(out, world);
            let ingredients = Ingredients { plan: self.plan(world)?, seed, into: self.into.clone() };
            let source = match proof::source(world, &ingredients, &place, &mut session.registry)? {
                Ok(source) => source,
                Err(reason) => {
                    skipped.insert(world, reason);
                    continue;
                }
            };
            let options = Options {
                keep: self.keep,
                without: !self.no_removal,
                oracle: self.oracle,
                varied: self.invariance.map_or(0, |cases| cases.unwrap_or(usize::MAX)),
                shard,
                program: program.clone(),
                trust: session.registry.trusted(),
            };
            let cases = source.planned().len();
            let into = ingredients.set_names(world);
            let remarks = source.remarks().to_vec();
            place.create(&Proof { seed, cases, into, remarks, plan: ingredients.plan })?;
            let progress = session.progress(shard.count(cases));
            proof::prove(&*source, &place, &options, &|case| {
                progress.step(format!("{} {case}", world.name()));
            })?;
        }
        Ok(skipped)
    }

    fn plan(&self, world: World) -> Result<Plan, Failure> {
        if self.small { Ok(proof::small(world)) } else { read_plan(self.plan.as_deref(), world) }
    }

    fn learn_from_proofs(&self) -> Result<Report, Failure> {
        let mut scores = Vec::new();
        for folder in &self.proofs {
            scores.extend(proof::report(folder, &BTreeMap::new())?.scores);
        }
        let Some(path) = &self.learn else {
            return Err(Failure::argument(
                "--proof",
                "proofs are named, and nothing is to be learnt from them",
                "name a file with --learn",
            ));
        };
        let learnt = proof::learn(path, &scores)?;
        let text: String = learnt
            .learnt_from
            .iter()
            .map(|l| {
                let (world, seed) = (l.world.as_str(), l.seed);
                format!(
                    "{world}, seed {seed}: {} cases, {} of {} findings right\n",
                    l.cases, l.hits, l.findings
                )
            })
            .collect();
        let json = json!({ "command": "prove", "learnt": learnt, "outputs": [path] });
        Ok(Report { text: format!("{text}{} written\n", path.display()), json, findings: false })
    }
}
