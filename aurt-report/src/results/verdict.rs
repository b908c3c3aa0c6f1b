//! A verdict on the style, in a dozen lines.

use std::fmt::Write as _;

use aurt::{Asked, Diagnosis, Explanation};
use aurt_diagnosis::{Answer, Verdict};

use crate::noise_report::NoiseReport;
use crate::rendering::style::{Emphasis, Style};
use crate::rendering::table::Table;
use crate::rendering::text::{WIDTH, wrapped, wrapped_with};
use crate::words::{
    Group, HOW_LARGE, all_indicated, band, claim, explained, follows, groups, headline, nothing, objection,
    undecidable, visible_gears,
};

#[derive(Debug, Clone, Copy)]
pub struct Shown<'a> {
    pub verdict: &'a Verdict,
    pub asked: Asked,
    pub unit: &'a str,
    /// What was held out, with its part of the recording.
    pub held_out: &'a [String],
    /// Warnings about the physics of the improved model, if there is one.
    pub about_physics: &'a [String],
    pub all_in: &'a str,
}

/// A terminal shows at most this many indications.
const SHOWN_INDICATIONS: usize = 3;

impl<'a> Shown<'a> {
    pub fn of(explanation: &'a Explanation) -> Self {
        let Diagnosis { verdict, asked, unit } = &explanation.diagnosis;
        let held_out = &verdict.held_out.recordings;
        let about_physics = &explanation.model.calibration.about_physics;
        Self { verdict, asked: *asked, unit: unit.symbol(), held_out, about_physics, all_in: "the report" }
    }
}

impl Shown<'_> {
    pub fn to_text(self, style: Style) -> String {
        let verdict = self.verdict;
        let mut text = style
            .emphasise(Emphasis::Title, wrapped_with(&headline(verdict, self.asked), WIDTH, "", "").trim());
        text.push('\n');
        for group in groups(verdict, self.asked) {
            self.group(&mut text, &group, style);
        }
        for model in &verdict.registered_models {
            let said = format!("{} (score {:.0})", model.sentence, model.evidence.score);
            text.push_str(&wrapped_with(&said, WIDTH, "  + ", "     "));
        }
        self.indications(&mut text);
        if text.contains('±') {
            text.push_str(&wrapped(
                "±: one standard deviation, with 2 % for the drives' gains in units of torque",
            ));
        }
        let warning = style.emphasise(Emphasis::Warning, "warning");
        for w in &verdict.warnings {
            text.push_str(&wrapped(&format!("{warning}: {w}")));
        }
        // How well its parameters are excited stands in the report; it says nothing about the answer.
        for w in self.about_physics {
            text.push_str(&wrapped(&format!("{warning}: the improved model: {w}")));
        }
        self.table(&mut text);
        text.push_str(&wrapped(&format!("held out: {}", self.held_out.join(", "))));
        text.extend(band(verdict).map(|said| wrapped(&said)));
        text.extend(explained(verdict).map(|said| wrapped(&said)));
        if !verdict.not_decidable.is_empty() {
            let names: Vec<String> =
                verdict.not_decidable.iter().map(|n| undecidable(n, verdict.names())).collect();
            text.push_str(&wrapped(&format!("not decidable here: {}", names.join(", "))));
        }
        text.extend(verdict.not_examined.iter().map(|n| wrapped(&format!("not examined: {}", n.reason))));
        text.extend(verdict.notes.iter().map(|n| wrapped(&format!("note: {n}"))));
        text.extend(visible_gears(verdict).map(|said| wrapped(&format!("note: {said}"))));
        if verdict.verdict == Answer::NoMismatch {
            text.push_str(&wrapped(HOW_LARGE));
        }
        text
    }

    fn group(&self, text: &mut String, group: &Group<'_>, style: Style) {
        if group.findings.is_empty() {
            let _ = writeln!(text, "{}: {}", group.title, nothing(self.verdict));
            return;
        }
        if !group.title.is_empty() {
            let _ = writeln!(text, "{}:", group.title);
        }
        for (number, finding) in &group.findings {
            let said = format!("{} (score {:.0})", claim(finding, self.asked), finding.evidence.score);
            text.push_str(&wrapped_with(&said, WIDTH, &format!("  {number}. "), "     "));
            if let Some(objection) = objection(self.verdict, finding, self.unit) {
                let warning = style.emphasise(Emphasis::Warning, "warning");
                let said = format!("{warning}: {objection}");
                text.push_str(&wrapped_with(&said, WIDTH, "     ", "     "));
            }
            for other in &finding.alternatives {
                let said = format!("or {}; to tell: {}", other.effect, other.record);
                text.push_str(&wrapped_with(&said, WIDTH, "     ", "     "));
            }
        }
    }

    fn table(&self, text: &mut String) {
        let Self { verdict, unit, .. } = *self;
        let (names, errors) = (verdict.names(), NoiseReport::of(verdict));
        let mut table = Table::new(["joint", "before", "after", "noise", "before", "after", "follows"])
            .group(1, "")
            .group(3, format!("residual rms [{unit}]"))
            .group(2, format!("held out [{unit}]"))
            .group(1, "")
            .left(usize::from(!names.joints.is_empty()))
            .remark();
        for residual in &verdict.residual {
            let j = residual.joint;
            let held = |list: &[f64]| {
                // A joint without rows has no error.
                list.get(j).filter(|v| **v > 0.0).map_or_else(|| "–".to_owned(), |v| format!("{v:.4}"))
            };
            table.row([
                names.joint_cell(j),
                format!("{:.4}", residual.baseline_rms),
                format!("{:.4}", residual.unexplained_rms),
                format!("{:.4}", residual.floor_rms),
                held(&verdict.held_out.rms_before),
                held(&verdict.held_out.rms_after),
                follows(residual, errors.joints.get(j)),
            ]);
        }
        let _ = write!(text, "\n{}", table.render());
    }

    fn indications(&self, text: &mut String) {
        let all = all_indicated(self.verdict, self.asked);
        for indication in all.iter().take(SHOWN_INDICATIONS) {
            text.push_str(&wrapped_with(indication, WIDTH, "  ? ", "     "));
        }
        match all.len().saturating_sub(SHOWN_INDICATIONS) {
            0 => {}
            1 => text.push_str(&wrapped(&format!("1 more indication is in {}", self.all_in))),
            more => text.push_str(&wrapped(&format!("{more} more indications are in {}", self.all_in))),
        }
    }
}

#[cfg(test)]
mod tests {
    use aurt_diagnosis::Indication;
    use aurt_diagnosis::vocabulary::Family;

    use super::*;
    use crate::words::tests::{finding, residual, verdict};

    fn text(verdict: &Verdict) -> String {
        let held_out = ["tuesday.mcap".to_owned()];
        let shown = Shown {
            verdict,
            asked: Asked::Lack,
            unit: "Nm",
            held_out: &held_out,
            about_physics: &[],
            all_in: "report.html",
        };
        shown.to_text(Style::PLAIN)
    }

    fn with_indications(count: usize) -> Verdict {
        let mut found = verdict(Answer::NoMismatch, Vec::new(), &[0.1], &[0.1]);
        let indication = |k: usize| Indication {
            finding: finding("stribeck", Family::F, &[0], &["calibration"]),
            fails: vec![format!("it is 1.{k} σ from zero")],
            usual: false,
        };
        found.indications = (0..count).map(indication).collect();
        found
    }

    #[test]
    fn three_indications_are_shown_and_the_others_counted() {
        for (count, shown, more) in [
            (0, 0, None),
            (3, 3, None),
            (4, 3, Some("1 more indication is in report.html")),
            (9, 3, Some("6 more indications are in report.html")),
        ] {
            let said = text(&with_indications(count));
            assert_eq!(said.matches("\n  ? ").count(), shown, "{said}");
            let line = said.lines().map(str::trim).find(|line| line.contains("more indication"));
            assert_eq!(line, more);
        }
    }

    #[test]
    fn an_indication_is_told_once() {
        let mut found = with_indications(2);
        let again = found.indications[0].clone();
        found.indications.insert(1, again);
        let said = text(&found);
        assert_eq!(said.matches("it is 1.0 σ from zero").count(), 1, "{said}");
        assert_eq!(said.matches("\n  ? ").count(), 2, "{said}");
    }

    #[test]
    fn a_table_of_joints_with_names_has_no_numbers_of_joints_and_fits_a_terminal() {
        let mut found = verdict(Answer::NoMismatch, Vec::new(), &[12.5, 0.2], &[12.5, 0.1]);
        found.joint_names = ["shoulder_pan_joint", "elbow"].map(str::to_owned).to_vec();
        found.residual = vec![residual(0, 12.5, true), residual(1, 0.1, false)];
        let said = text(&found);
        assert!(said.lines().all(|line| line.chars().count() <= WIDTH), "{said}");
        assert!(said.contains("\n  shoulder_pan_joint  12.5000"), "{said}");
        assert!(said.contains("\n  elbow                0.1000"), "{said}");
    }
}
