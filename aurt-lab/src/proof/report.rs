//! What a proof came to: the tables, and everything as JSON.

use std::{collections::BTreeMap, fmt::Write as _, path::Path};

use crate::{
    case::{CaseType, World},
    product::Failure,
    score::{CaseScore, Scoreboard},
};
use serde_json::{Map, Value, json};

use super::{
    Place, Proof, Verdicts,
    diagnosed::complaints,
    scores::{add_oracle, add_variants, scores_so_far},
};

/// The simpler methods of `comparison.json`, by their keys in it.
const METHODS: [&str; 3] = ["best_single", "lasso", "stlsq"];

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
    let mut methods: BTreeMap<&str, Vec<CaseScore>> = BTreeMap::new();
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
        for method in METHODS {
            let whose = Verdicts::Method(method.to_owned());
            let scores = scores_so_far(&place.sealed(), &place.verdicts(), &whose)?;
            methods.entry(method).or_default().extend(scores);
        }
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
    let boards: Map<String, Value> =
        methods.iter().map(|(name, scores)| ((*name).to_owned(), json!(Scoreboard::of(scores)))).collect();
    text.push_str(&comparison(&all, &methods));
    for (case, complaint) in &failed {
        let _ = writeln!(text, "\n{case}: {complaint}");
    }
    let json = json!({
        "command": "prove", "worlds": worlds, "failed": failed, "board": board, "methods": boards, "cases": all,
    });
    Ok(Proven { text, json, is_incomplete: !failed.is_empty(), scores })
}

fn head(world: World, proof: &Proof, scored: usize) -> String {
    let of = if scored < proof.cases { format!(" of {}", proof.cases) } else { String::new() };
    let into =
        if proof.into.is_empty() { String::new() } else { format!(", into {}", proof.into.join(", ")) };
    format!("{}: {scored}{of} cases, seed {}{into}", world.name(), proof.seed)
}

/// What a comparison counts: its name, and whether a case is of it and right.
type Counted = (&'static str, fn(&CaseScore) -> Option<bool>);

const COUNTED: [Counted; 5] = [
    ("singles: first label", |s| (s.case_type == CaseType::Single).then_some(s.first_label)),
    ("singles: all right", |s| (s.case_type == CaseType::Single).then_some(s.right)),
    ("pairs: both first", |s| (s.case_type == CaseType::Pair).then_some(s.first_label)),
    ("nulls flagged", |s| (s.case_type == CaseType::Null).then_some(!s.right)),
    ("unknown effects: unexplained", |s| (s.case_type == CaseType::UnknownEffect).then_some(s.right)),
];

/// The diagnosis and simpler methods on the same cases, a column for every world.
fn comparison(own: &[CaseScore], methods: &BTreeMap<&str, Vec<CaseScore>>) -> String {
    if methods.values().all(Vec::is_empty) {
        return String::new();
    }
    let worlds: Vec<World> = World::ALL.into_iter().filter(|w| own.iter().any(|s| s.world == *w)).collect();
    let names: Vec<&str> = worlds.iter().map(|w| w.name()).collect();
    let mut text = format!(
        "\n| method | what is counted | {} |\n|{}\n",
        names.join(" | "),
        "---|".repeat(2 + names.len())
    );
    let rows = std::iter::once(("aurt diagnose", own)).chain(methods.iter().map(|(n, s)| (*n, s.as_slice())));
    for (name, scores) in rows {
        for (what, counted) in COUNTED {
            let cell = |world: &World| {
                let of =
                    scores.iter().filter(|s| s.world == *world && s.removed.is_none() && !s.known_before);
                let all: Vec<bool> = of.filter_map(counted).collect();
                let right = all.iter().filter(|is| **is).count();
                if all.is_empty() { "–".to_owned() } else { format!("{right}/{}", all.len()) }
            };
            let cells: Vec<String> = worlds.iter().map(cell).collect();
            let _ = writeln!(text, "| {} | {what} | {} |", name.replace('_', " "), cells.join(" | "));
        }
    }
    text
}
