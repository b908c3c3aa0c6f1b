use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use super::board::Scoreboard;
use super::invariance::Invariance;
use super::share::Share;
use super::world_board::{Singles, WorldBoard};
use crate::case::World;
use crate::strength::Strength;

/// A cell without a value.
const NOTHING: &str = "–";

impl Scoreboard {
    /// The board as Markdown tables, each with a column for every world.
    pub fn markdown(&self) -> String {
        let mut text = self.summary();
        text.push_str(&self.flagged());
        text.push_str(&self.invariance());
        text.push_str(&self.effects());
        text.push_str(&self.confusion());
        text.push_str(&self.reliability());
        text
    }

    /// The worlds of the columns, those that were skipped included.
    fn columns(&self) -> Vec<World> {
        let known = |w: &World| self.worlds.contains_key(w) || self.skipped.contains_key(w);
        World::ALL.into_iter().filter(known).collect()
    }

    fn head(&self, keys: &[&str]) -> String {
        let worlds: Vec<&str> = self.columns().iter().map(|w| w.name()).collect();
        let count = keys.len() + worlds.len();
        format!("| {} | {} |\n|{}\n", keys.join(" | "), worlds.join(" | "), "---|".repeat(count))
    }

    fn row(&self, keys: &[&str], cell: impl Fn(&WorldBoard) -> Option<String>) -> String {
        let cells: Vec<String> = self
            .columns()
            .iter()
            .map(|w| match self.worlds.get(w) {
                Some(board) => cell(board).unwrap_or_else(|| NOTHING.to_owned()),
                None => "skipped".to_owned(),
            })
            .collect();
        format!("| {} | {} |\n", keys.join(" | "), cells.join(" | "))
    }

    fn summary(&self) -> String {
        let mut text = self.head(&["what is counted"]);
        let mut line = |what: &str, cell: &dyn Fn(&WorldBoard) -> Option<String>| {
            let is_empty = self.worlds.values().all(|b| cell(b).is_none());
            if !is_empty {
                text.push_str(&self.row(&[what], cell));
            }
        };
        line("cases", &|b| Some(b.cases.to_string()));
        line("diagnoses that failed (0 is right)", &|b| (b.failed > 0).then(|| b.failed.to_string()));
        line("left out: claimed without the effect too", &|b| {
            (b.known_before > 0).then(|| b.known_before.to_string())
        });
        for strength in Strength::ALL {
            let name = strength.name();
            for (what, cell) in SINGLES {
                line(&format!("{name}: {what}"), &|b| cell(b.singles.get(&strength)?));
            }
        }
        let share = |share: Share| (share.of > 0).then(|| share.to_string());
        line("**pairs: both right, no other claim**", &|b| share(b.pairs));
        line("pairs: both named first, whatever the verdict", &|b| share(b.pairs_first_labels));
        line("pairs: effects named at all", &|b| share(b.effects_of_pairs));
        line("**nulls flagged** (0 is right)", &|b| share(b.nulls_flagged));
        line("nulls whose structural claims are those of other recordings", &|b| share(b.nulls_agree));
        line("**outside the vocabulary: unexplained**", &|b| share(b.unknown_effects));
        line("outside the vocabulary: claims a case (0 is right)", &|b| number(b.beside_unknown_effects));
        line("candidate removed: unexplained or a neighbour", &|b| share(b.removed));
        line("candidate removed: unnoticed (0 is right)", &|b| share(b.removed_unnoticed));
        line("claims that are not true, of a case of any kind (0 is right)", &|b| number(b.beside));
        line("joints on which a black box is better by 5 % (0 is right)", &|b| share(b.rival_better));
        line("Brier score of the printed confidence (0 is right)", &|b| decimals(b.reliability.brier));
        line("Brier score of confidence learnt on the other worlds", &|b| {
            decimals(b.reliability_learnt_elsewhere.as_ref()?.brier)
        });
        text
    }

    fn flagged(&self) -> String {
        let names: BTreeSet<&String> = self.worlds.values().flat_map(|b| b.flagged_by.keys()).collect();
        if names.is_empty() {
            return String::new();
        }
        let mut text = format!("\n{}", self.head(&["nulls flagged by"]));
        for name in names {
            let cell = |b: &WorldBoard| {
                (b.nulls_flagged.of > 0)
                    .then(|| format!("{}/{}", b.flagged_by.get(name).unwrap_or(&0), b.nulls_flagged.of))
            };
            text.push_str(&self.row(&[&format!("`{name}`")], cell));
        }
        text
    }

    /// Shares of the same claims, and the claims that appear or vanish.
    fn invariance(&self) -> String {
        let boards = || self.worlds.values().filter_map(|b| b.invariance.as_ref());
        if boards().next().is_none() {
            return String::new();
        }
        let mut text = format!("\n{}", self.head(&["the same claims"]));
        let mut line = |what: &str, share: &dyn Fn(&Invariance) -> Option<Share>| {
            text.push_str(&self.row(&[what], |b| shown(share(b.invariance.as_ref()?)?)));
        };
        line("**over all variants**", &|i| Some(i.same));
        line("over all variants: claims of both, of those of either", &|i| Some(i.claims));
        let variants: BTreeSet<&String> = boards().flat_map(|i| i.variants.keys()).collect();
        for variant in variants {
            line(&format!("`{variant}`"), &|i| i.variants.get(variant).copied());
        }
        line("**both halves of the reference**, structure", &|i| Some(i.halves));
        if boards().all(|i| i.differences.is_empty()) {
            return text;
        }
        text.push_str("\n| world | case | variant | appears | vanishes |\n|---|---|---|---|---|\n");
        for (world, board) in &self.worlds {
            for difference in board.invariance.iter().flat_map(|i| &i.differences) {
                let list = |claims: &[String]| {
                    if claims.is_empty() { NOTHING.to_owned() } else { claims.join(", ") }
                };
                let (appeared, vanished) =
                    (list(&difference.claims.appeared), list(&difference.claims.vanished));
                let _ = writeln!(
                    text,
                    "| {} | {} | `{}` | {appeared} | {vanished} |",
                    world.name(),
                    difference.case,
                    difference.variant
                );
            }
        }
        text
    }

    /// Right and first label of every effect.
    fn effects(&self) -> String {
        let mut rows: BTreeMap<(&str, Strength), BTreeMap<World, &Singles>> = BTreeMap::new();
        for (world, board) in &self.worlds {
            for row in &board.effects {
                rows.entry((&row.effect, row.strength)).or_default().insert(*world, &row.counts);
            }
        }
        if rows.is_empty() {
            return String::new();
        }
        let mut text = format!(
            "\nAll right · first label right, whatever the verdict / cases.\n\n{}",
            self.head(&["effect", "strength"])
        );
        for ((effect, strength), counts) in rows {
            let cells: Vec<String> = self
                .columns()
                .iter()
                .map(|w| {
                    counts.get(w).map_or_else(
                        || NOTHING.to_owned(),
                        |c| format!("{} · {} / {}", c.right.count, c.first_label.count, c.right.of),
                    )
                })
                .collect();
            let _ = writeln!(text, "| `{effect}` | {} | {} |", strength.name(), cells.join(" | "));
        }
        text
    }

    fn confusion(&self) -> String {
        let mut rows: BTreeMap<(&str, &str), BTreeMap<World, usize>> = BTreeMap::new();
        for (world, board) in &self.worlds {
            for entry in &board.confusion {
                rows.entry((&entry.truth, &entry.called)).or_default().insert(*world, entry.count);
            }
        }
        if rows.is_empty() {
            return String::new();
        }
        let mut rows: Vec<_> = rows.into_iter().collect();
        rows.sort_by_key(|(_, counts)| std::cmp::Reverse(counts.values().sum::<usize>()));
        let mut text = format!("\n{}", self.head(&["was", "was called"]));
        for ((truth, called), counts) in rows {
            let cells: Vec<String> = self
                .columns()
                .iter()
                .map(|w| counts.get(w).map_or_else(|| NOTHING.to_owned(), ToString::to_string))
                .collect();
            let _ = writeln!(text, "| `{truth}` | {called} | {} |", cells.join(" | "));
        }
        text
    }

    fn reliability(&self) -> String {
        let mut edges: BTreeMap<u32, f64> = BTreeMap::new();
        for bin in self.worlds.values().flat_map(|b| &b.reliability.bins) {
            edges.insert((1000.0 * bin.from) as u32, bin.to);
        }
        if edges.is_empty() {
            return String::new();
        }
        let mut text = format!(
            "\nFindings of a confidence: mean claimed, and those that were right.\n\n{}",
            self.head(&["printed confidence"])
        );
        for (from, to) in edges {
            let from = f64::from(from) / 1000.0;
            let cell = |b: &WorldBoard| {
                let bin = b.reliability.bins.iter().find(|bin| (bin.from - from).abs() < 1e-6)?;
                Some(format!("{:.2}: {}", bin.claimed, bin.hits))
            };
            text.push_str(&self.row(&[&format!("{from:.2}–{to:.2}")], cell));
        }
        text
    }
}

type Cell = fn(&Singles) -> Option<String>;

const SINGLES: [(&str, Cell); 15] = [
    ("**all right**", |s| shown(s.right)),
    ("seen by the oracle: claimed where it alone is examined", |s| shown(s.seen)),
    ("**efficiency**: all right, of those seen by the oracle", |s| shown(s.efficiency)),
    ("all right, inseparable labels as one", |s| shown(s.right_class)),
    ("first label, whatever the verdict", |s| shown(s.first_label)),
    ("first label, inseparable labels as one", |s| shown(s.first_label_class)),
    ("label anywhere", |s| shown(s.anywhere)),
    ("a verdict that names an effect, whichever it is", |s| shown(s.named)),
    ("claims that are not true a case (0 is right)", |s| number(s.beside)),
    ("right presence, of those labelled", |s| shown(s.presence)),
    ("exactly the joints", |s| shown(s.joints)),
    ("joints of the first label, mean F1", |s| number(s.joint_f1)),
    ("parameters within two claimed σ", |s| shown(s.coverage)),
    ("contacts: overlap of the window, mean", |s| number(s.window_overlap)),
    ("held-out improvement recovered, mean of all", |s| s.recovered.map(|r| format!("{:.0} %", 100.0 * r))),
];

fn shown(share: Share) -> Option<String> {
    (share.of > 0).then(|| share.to_string())
}

fn number(value: Option<f64>) -> Option<String> {
    value.map(|v| format!("{v:.2}"))
}

fn decimals(value: Option<f64>) -> Option<String> {
    value.map(|v| format!("{v:.3}"))
}
