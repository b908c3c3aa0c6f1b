use std::fmt;
use std::fmt::Write as _;

use super::board::{Scoreboard, Share};

impl fmt::Display for Share {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.ratio() {
            Some(ratio) => write!(f, "{}/{} ({:.0} %)", self.count, self.of, 100.0 * ratio),
            None => write!(f, "–"),
        }
    }
}

impl Scoreboard {
    /// The board as Markdown tables.
    #[must_use]
    pub fn markdown(&self) -> String {
        let mut text = String::from("| cases | right |\n|---|---|\n");
        let mut line = |what: String, value: String| {
            let _ = writeln!(text, "| {what} | {value} |");
        };
        for (strength, share) in &self.singles {
            let name = strength.name();
            line(format!("single effects, {name}: first label"), share.to_string());
            if let Some(share) = self.singles_with_alternatives.get(strength) {
                line(format!("single effects, {name}: with declared alternatives"), share.to_string());
            }
            if let Some(share) = self.families.get(strength) {
                line(format!("single effects, {name}: family"), share.to_string());
            }
            if let Some(f1) = self.joint_f1.get(strength) {
                line(format!("single effects, {name}: joints, mean F1"), format!("{f1:.2}"));
            }
        }
        let shares = [
            ("pairs: both named first", self.pairs),
            ("pairs: effects named at all", self.effects_of_pairs),
            ("nulls flagged (0 is right)", self.nulls_flagged),
            ("outside the vocabulary: unexplained", self.strangers),
            ("candidate removed: unexplained or a neighbour", self.removed),
            ("candidate removed: unnoticed (0 is right)", self.removed_unnoticed),
        ];
        for (what, share) in shares.into_iter().filter(|(_, share)| share.of > 0) {
            line(what.to_owned(), share.to_string());
        }
        if let Some(overlap) = self.window_overlap {
            line("contacts: overlap of the window, mean".into(), format!("{overlap:.2}"));
        }
        if let Some(recovered) = self.recovered {
            line("held-out improvement recovered, median".into(), format!("{:.0} %", 100.0 * recovered));
        }
        text.push_str(&self.effect_table());
        text.push_str(&self.confusion_table());
        text.push_str(&self.reliability_table());
        text
    }

    fn effect_table(&self) -> String {
        if self.effects.is_empty() {
            return String::new();
        }
        let mut text = String::from(
            "\n| effect | strength | first label | with alternatives | family | joints F1 | parameters off by | \
             recovered |\n|---|---|---|---|---|---|---|---|\n",
        );
        let plain = |share: &Share| format!("{}/{}", share.count, share.of);
        let percent = |value: Option<f64>| value.map_or("–".into(), |v| format!("{:.0} %", 100.0 * v));
        for row in &self.effects {
            let _ = writeln!(
                text,
                "| `{}` | {} | {} | {} | {} | {} | {} | {} |",
                row.effect,
                row.strength.name(),
                plain(&row.right),
                plain(&row.right_with_alternatives),
                plain(&row.right_family),
                row.joint_f1.map_or("–".into(), |v| format!("{v:.2}")),
                percent(row.parameter_error),
                percent(row.recovered),
            );
        }
        text
    }

    fn confusion_table(&self) -> String {
        if self.confusion.is_empty() {
            return String::new();
        }
        let mut text = String::from("\n| was | was called | times |\n|---|---|---|\n");
        for entry in &self.confusion {
            let _ = writeln!(text, "| `{}` | `{}` | {} |", entry.truth, entry.called, entry.count);
        }
        text
    }

    fn reliability_table(&self) -> String {
        if self.reliability.is_empty() {
            return String::new();
        }
        let mut text = String::from(
            "\n| score of the first label | claimed confidence, mean | first label right |\n|---|---|---|\n",
        );
        for row in &self.reliability {
            let range = if row.to_score.is_finite() {
                format!("{:.0}–{:.0}", row.from_score, row.to_score)
            } else {
                format!("{:.0} and above", row.from_score)
            };
            let _ = writeln!(text, "| {range} | {:.2} | {} |", row.claimed, row.right);
        }
        text
    }
}
