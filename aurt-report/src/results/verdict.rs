//! A verdict on the style, in a dozen lines.

use std::fmt::Write as _;

use aurt::{Asked, Diagnosis, Explanation};
use aurt_diagnosis::{Answer, Verdict};

use crate::{
    rendering::{
        style::{Emphasis, Style},
        text::{WIDTH, wrapped, wrapped_with},
    },
    words::{
        Group, HOW_LARGE, claim, explained, follows, groups, headline, indicated, nothing, objection,
        undecidable,
    },
};

/// What a terminal shows of a verdict.
#[derive(Debug, Clone, Copy)]
pub struct Shown<'a> {
    /// The verdict.
    pub verdict: &'a Verdict,
    /// What was asked.
    pub asked: Asked,
    /// Symbol of the measurement's unit.
    pub unit: &'a str,
    /// What was held out, with its part of the recording.
    pub held_out: &'a [String],
    /// Warnings about the physics of the improved model, if there is one.
    pub about_physics: &'a [String],
}

impl<'a> Shown<'a> {
    /// Of a diagnosis of recordings in memory.
    #[must_use]
    pub fn of(explanation: &'a Explanation) -> Self {
        let Diagnosis { verdict, asked, unit } = &explanation.diagnosis;
        let held_out = &verdict.held_out.recordings;
        let about_physics = &explanation.model.calibration.about_physics;
        Self { verdict, asked: *asked, unit: unit.symbol(), held_out, about_physics }
    }
}

impl Shown<'_> {
    /// The lines.
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
        for indication in &verdict.indications {
            text.push_str(&wrapped_with(&indicated(indication, self.asked), WIDTH, "  ? ", "     "));
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
        text.extend(explained(verdict).map(|said| wrapped(&said)));
        if !verdict.not_decidable.is_empty() {
            let names: Vec<String> = verdict.not_decidable.iter().map(undecidable).collect();
            text.push_str(&wrapped(&format!("not decidable here: {}", names.join(", "))));
        }
        text.extend(verdict.not_examined.iter().map(|n| wrapped(&format!("not examined: {}", n.reason))));
        text.extend(verdict.notes.iter().map(|n| wrapped(&format!("note: {n}"))));
        if verdict.verdict == Answer::NoMismatch {
            text.push_str(&wrapped(HOW_LARGE));
        }
        text
    }

    fn group(&self, text: &mut String, group: &Group<'_>, style: Style) {
        if group.findings.is_empty() {
            let _ = writeln!(text, "{}: {}", group.title, nothing(self.verdict.verdict));
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
        let (verdict, unit) = (self.verdict, self.unit);
        let _ = writeln!(text, "\n  joint   residual rms [{unit}]            held out [{unit}]");
        let _ = writeln!(text, "          before    after    noise    before    after  follows");
        for residual in &verdict.residual {
            let j = residual.joint;
            let held = |list: &[f64]| {
                // A joint without rows has no error.
                list.get(j).filter(|v| **v > 0.0).map_or_else(|| "–".to_owned(), |v| format!("{v:.4}"))
            };
            let line = format!(
                "  {j:>5} {:>9.4}{:>9.4}{:>9.4}{:>10}{:>9}  {}",
                residual.baseline_rms,
                residual.unexplained_rms,
                residual.floor_rms,
                held(&verdict.held_out.rms_before),
                held(&verdict.held_out.rms_after),
                follows(residual),
            );
            let _ = writeln!(text, "{}", line.trim_end());
        }
    }
}
