//! What a proof came to: the tables, and everything as JSON.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use crate::case::World;
use crate::product::Failure;
use crate::score::{CaseScore, Scoreboard};
use serde_json::{Map, Value, json};

use super::diagnosed::complaints;
use super::scores::{add_oracle, add_variants, scores_so_far};
use super::{Place, Proof, Verdicts};

/// What a folder has proved so far.
#[derive(Debug)]
pub struct Proven {
    pub text: String,
    pub json: Value,
    /// Whether cases could not be made or diagnosed.
    pub is_incomplete: bool,
    pub scores: Vec<(World, u64, Vec<CaseScore>)>,
}

pub fn report(out: &Path, skipped: &BTreeMap<World, String>) -> Result<Proven, Failure> {
    let mut text = String::new();
    let mut scores: Vec<(World, u64, Vec<CaseScore>)> = Vec::new();
    let mut failed: BTreeMap<String, String> = BTreeMap::new();
    let mut worlds = Map::new();
    for world in World::ALL {
        let place = Place::new(out, world);
        let Some(proof) = place.proof()? else { continue };
        let mut own = scores_so_far(&place.sealed(), &place.verdicts(), &Verdicts::Own)?;
        add_oracle(&mut own, &place.sealed(), &place.verdicts(), &place.oracle())?;
        add_variants(&mut own, &place)?;
        let unmade = complaints(&place)?;
        let _ = writeln!(text, "{}", head(world, &proof, own.len()));
        proof.remarks.iter().for_each(|line| {
            let _ = writeln!(text, "{line}");
        });
        worlds.insert(
            world.name().to_owned(),
            json!({ "proof": proof, "scored": own.len(), "failed": unmade }),
        );
        failed.extend(unmade.into_iter().map(|(case, why)| (format!("{} {case}", world.name()), why)));
        let mut all = own;
        let removed = Verdicts::Removed { own: place.verdicts() };
        all.extend(scores_so_far(&place.sealed(), &place.removed(), &removed)?);
        scores.push((world, proof.seed, all));
    }
    if scores.is_empty() && skipped.is_empty() {
        return Err(Failure::argument(
            "--out",
            format!("{} holds no proof", out.display()),
            "make one with `aurt-lab prove --seed 7 --out DIR`",
        ));
    }
    for (world, reason) in skipped {
        let _ = writeln!(text, "world {}: skipped: {reason}", world.name());
    }
    let all: Vec<CaseScore> = scores.iter().flat_map(|(.., s)| s.clone()).collect();
    let mut board = Scoreboard::of(&all);
    board.skipped.clone_from(skipped);
    let _ = write!(text, "\n{}", board.markdown());
    for (case, complaint) in &failed {
        let _ = writeln!(text, "\n{case}: {complaint}");
    }
    let json = json!({
        "command": "prove", "worlds": worlds, "failed": failed, "board": board, "cases": all,
    });
    Ok(Proven { text, json, is_incomplete: !failed.is_empty(), scores })
}

fn head(world: World, proof: &Proof, scored: usize) -> String {
    let of = if scored < proof.cases { format!(" of {}", proof.cases) } else { String::new() };
    let into =
        if proof.into.is_empty() { String::new() } else { format!(", into {}", proof.into.join(", ")) };
    format!("{}: {scored}{of} cases, seed {}{into}", world.name(), proof.seed)
}
