//! `aurt prove`: how often a diagnosis is right, on cases whose truth is known and hidden from it.

use std::{collections::BTreeMap, fmt::Write as _, path::PathBuf};

use aurt_simulation::{case::Plan, score::Scoreboard};
use clap::Args;
use serde_json::json;

use crate::{
    commands::Session,
    failure::Failure,
    output::OutputFolder,
    proof::{self, Options, Place, Verdicts, read_scores},
    rendering::{json::pretty, terminal::Report},
};

/// Count how often a diagnosis is right: conceal effects, diagnose each case in a process of its own that sees
/// nothing but the case's folder, score.
///
/// Every case of one effect is diagnosed once more with that effect's candidate removed, and simpler methods answer
/// the same cases. Cases that were diagnosed before are skipped: a proof that was interrupted goes on.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  aurt prove --seed 7 --out proof\n  \
    aurt prove --plan examples/proof/full.toml --seed 20261120 --out proof")]
pub struct Prove {
    /// Which cases to make; without it every effect once, two strangers, two pairs and four nulls
    #[arg(long, value_name = "PLAN.toml")]
    plan: Option<PathBuf>,
    /// Seed of everything that is drawn
    #[arg(long, value_name = "N")]
    seed: u64,
    /// Folder for truths, verdicts and the scoreboard; created if it does not exist
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Keep the recordings of the cases (some 15 MB each)
    #[arg(long)]
    keep: bool,
    /// Do not diagnose cases once more with their candidate removed
    #[arg(long)]
    no_removal: bool,
    /// Write the scoreboard of what has been diagnosed so far, and diagnose no further cases
    #[arg(long)]
    so_far: bool,
}

/// The file that says which proof a folder holds.
const PLAN: &str = "plan.json";

impl Prove {
    /// Proves.
    pub fn run(&self, session: &Session<'_>) -> Result<Report, Failure> {
        let folder = OutputFolder::new("--out", &self.out)?;
        let plan = self.plan.as_ref().map_or_else(|| Ok(Plan::small()), Plan::read)?;
        let this = pretty(&json!({ "plan": plan, "seed": self.seed }));
        if let Ok(other) = std::fs::read_to_string(self.out.join(PLAN))
            && other != this
        {
            return Err(Failure::Output {
                option: "--out",
                path: self.out.clone(),
                reason: "holds a proof of another plan or seed".into(),
                remedy: "name another folder".into(),
            });
        }
        folder.write(&[(PLAN.to_owned(), this.into_bytes())])?;
        let place = Place::new(folder.path());
        let planned = plan.requests(self.seed)?.len();
        let failed = if self.so_far {
            BTreeMap::new()
        } else {
            let progress = session.terminal.points_bar(planned);
            let options = Options { keep: self.keep, without: !self.no_removal };
            proof::prove(&plan, self.seed, &place, options, &|case| progress.step(case))?
        };

        let own = read_scores(&place.sealed(), &place.verdicts(), &Verdicts::Own)?;
        let mut scores = own.clone();
        if !self.no_removal {
            scores.extend(read_scores(&place.sealed(), &place.removed(), &Verdicts::Removed)?);
        }
        let board = Scoreboard::of(&scores);
        let of = if own.len() < planned { format!(" of {planned}") } else { String::new() };
        let mut text = format!("{}{of} cases, seed {}\n\n{}", own.len(), self.seed, board.markdown());
        let mut methods = serde_json::Map::new();
        for method in aurt_diagnosis::Method::ALL {
            let whose = Verdicts::Method(method.name().to_owned());
            if let Ok(scores) = read_scores(&place.sealed(), &place.verdicts(), &whose) {
                methods.insert(method.name().to_owned(), json!(Scoreboard::of(&scores)));
            }
        }
        text.push_str(&comparison(&board, &methods));
        for (case, complaint) in &failed {
            let _ = writeln!(text, "\n{case}: {complaint}");
        }
        let json = json!({
            "command": "prove", "seed": self.seed, "failed": failed, "board": board, "methods": methods,
            "cases": scores,
        });
        folder.write(&[
            ("scoreboard.json".to_owned(), pretty(&json).into_bytes()),
            ("scoreboard.md".to_owned(), text.clone().into_bytes()),
        ])?;
        Ok(Report { text, json, findings: !failed.is_empty() })
    }
}

/// The diagnosis beside simpler methods on the same cases.
fn comparison(own: &Scoreboard, methods: &serde_json::Map<String, serde_json::Value>) -> String {
    if methods.is_empty() {
        return String::new();
    }
    let mut text = String::from(
        "\n| method | singles: first label | pairs: both | nulls flagged | strangers unexplained |\n\
         |---|---|---|---|---|\n",
    );
    let mut row = |name: &str, board: &serde_json::Value| {
        let share = |key: &str| {
            let count = |k: &str| board[key][k].as_u64().unwrap_or(0);
            format!("{}/{}", count("count"), count("of"))
        };
        let sum = |k: &str| {
            let strengths = board["singles"].as_object();
            strengths.map_or(0, |s| s.values().filter_map(|v| v[k].as_u64()).sum::<u64>())
        };
        let singles = format!("{}/{}", sum("count"), sum("of"));
        let (pairs, nulls, strangers) = (share("pairs"), share("nulls_flagged"), share("strangers"));
        let _ = writeln!(text, "| {name} | {singles} | {pairs} | {nulls} | {strangers} |");
    };
    row("aurt diagnose", &json!(own));
    for (name, board) in methods {
        row(&name.replace('_', " "), board);
    }
    text
}
