//! The error of each joint against its noise floor: the one value from which headline, sign, arm and table of a diagnosis
//! are made.

use aurt::Asked;
use aurt_diagnosis::{Answer, Verdict};

use crate::figure::{NOISE_LIMIT, Shade};
use crate::page::Tone;

/// A joint's error with the claimed effects, against its noise floor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum NoiseState {
    NotJudged,
    WithinNoise,
    /// It exceeds the noise floor, and no structure is claimed in it.
    AboveNoise,
    /// It has a structure that no claimed effect explains.
    Structured,
}

/// The error of one joint in multiples of its noise floor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointNoise {
    /// Without the claimed effects.
    pub before: Option<f64>,
    pub after: Option<f64>,
    pub state: NoiseState,
}

impl JointNoise {
    /// Its colour with the claimed effects: that of noise only where noise explains it.
    pub fn shade(&self) -> Option<Shade> {
        let shade = Shade::of(self.after?);
        // A structure in the fitted rows is more than noise, however small the held-out error is.
        let level = if self.state > NoiseState::WithinNoise { shade.level.max(1) } else { shade.level };
        Some(Shade { level, ..shade })
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct NoiseReport {
    /// Whether they are of held-out rows; of the fitted rows where nothing was held out.
    pub is_held_out: bool,
    pub joints: Vec<JointNoise>,
}

impl NoiseReport {
    pub fn of(verdict: &Verdict) -> Self {
        let held = &verdict.held_out;
        let lists = [&held.rms_before, &held.rms_after, &held.rms_floor];
        let joints = verdict.residual.iter().map(|r| r.joint + 1).max().unwrap_or(0).max(lists[0].len());
        let is_held_out = lists.iter().all(|list| list.len() == joints);
        let multiple = |error: f64, noise: f64| Some(error / noise).filter(|m| m.is_finite());
        let error = |joint: usize| {
            let residual = verdict.residual.iter().find(|r| r.joint == joint);
            let [before, after] = if is_held_out {
                [held.rms_before[joint], held.rms_after[joint]].map(|e| multiple(e, held.rms_floor[joint]))
            } else {
                let of = |r: &aurt_diagnosis::JointResidual| {
                    [r.baseline_rms, r.unexplained_rms].map(|e| multiple(e, r.floor_rms))
                };
                residual.map_or([None; 2], of)
            };
            let state = match (residual.is_some_and(|r| r.structure_left), after) {
                (true, _) => NoiseState::Structured,
                (false, Some(multiple)) if multiple > NOISE_LIMIT => NoiseState::AboveNoise,
                (false, Some(_)) => NoiseState::WithinNoise,
                (false, None) => NoiseState::NotJudged,
            };
            JointNoise { before, after, state }
        };
        Self { is_held_out, joints: (0..joints).map(error).collect() }
    }

    pub fn in_state(&self, state: NoiseState) -> Vec<usize> {
        (0..self.joints.len()).filter(|joint| self.joints[*joint].state == state).collect()
    }

    pub fn beyond_noise(&self) -> Vec<usize> {
        (0..self.joints.len()).filter(|joint| self.joints[*joint].state > NoiseState::WithinNoise).collect()
    }

    /// The sign beside an answer: good only where the answer is clean, every judged joint is within noise, and no change is indicated.
    pub fn tone(&self, verdict: &Verdict, asked: Asked) -> Tone {
        let answers = [Some(verdict.verdict), verdict.structure.filter(|_| asked == Asked::Change)];
        let has = |wanted: &[Answer]| answers.iter().flatten().any(|answer| wanted.contains(answer));
        let indicates = asked == Asked::Change && !verdict.indicated_changes(false).is_empty();
        let is_judged = self.joints.iter().any(|joint| joint.state != NoiseState::NotJudged);
        if has(&[Answer::Unexplained, Answer::HeldOutDiffers]) {
            Tone::Attention
        } else if has(&[Answer::Named, Answer::PartlyExplained]) {
            Tone::Found
        } else if is_judged && !indicates && self.beyond_noise().is_empty() {
            Tone::Good
        } else {
            Tone::Attention
        }
    }
}

#[cfg(test)]
mod tests {
    use aurt_diagnosis::Finding;
    use aurt_diagnosis::vocabulary::Family;

    use super::*;
    use crate::words::tests::{finding, residual};
    use crate::words::{self};

    const FLOOR: f64 = 0.1;
    const ASKED: [Asked; 3] = [Asked::Change, Asked::Lack, Asked::Beyond];
    const ANSWERS: [Answer; 5] = [
        Answer::NoMismatch,
        Answer::Named,
        Answer::PartlyExplained,
        Answer::Unexplained,
        Answer::HeldOutDiffers,
    ];

    /// A verdict on one joint whose error is that multiple of its noise floor.
    fn verdict(answer: Answer, structure: Option<Answer>, times: f64, left: bool, held_out: bool) -> Verdict {
        let effects: Vec<Finding> = if answer == Answer::NoMismatch {
            Vec::new()
        } else {
            vec![finding("stribeck", Family::F, &[0], &["target"])]
        };
        let errors = if held_out { vec![times * FLOOR] } else { Vec::new() };
        let mut verdict = words::tests::verdict(answer, effects, &errors, &errors);
        verdict.structure = structure;
        verdict.residual = vec![residual(0, times * FLOOR, left)];
        verdict
    }

    /// Sign, headline, table and arm of every answer, question and state of a joint.
    #[test]
    fn no_part_of_a_report_contradicts_another() {
        let structures = [None].into_iter().chain(ANSWERS.map(Some));
        let multiples = [0.9, 1.0, 1.499, 1.501, 2.9, 40.0, f64::NAN];
        let mut ticks = 0;
        for structure in structures {
            for (answer, asked) in ANSWERS.iter().flat_map(|answer| ASKED.map(|asked| (*answer, asked))) {
                for (times, left, held_out) in multiples.iter().flat_map(|t| {
                    [(*t, false, true), (*t, true, true), (*t, false, false), (*t, true, false)]
                }) {
                    let found = verdict(answer, structure, times, left, held_out);
                    let report = NoiseReport::of(&found);
                    let case = format!("{answer:?} {structure:?} {asked:?} {times} {left} {held_out}");
                    let (tone, headline) = (report.tone(&found, asked), words::headline(&found, asked));
                    let is_beyond = times > NOISE_LIMIT || left;
                    assert_eq!(!report.beyond_noise().is_empty(), is_beyond, "{case}");
                    let row = words::follows(&found.residual[0], report.joints.first());
                    assert_eq!(!row.is_empty(), is_beyond, "{case}: {row}");
                    if let Some(shade) = report.joints[0].shade() {
                        assert_eq!(shade.level > 0, is_beyond, "{case}");
                    }
                    if tone == Tone::Good {
                        ticks += 1;
                        assert!(answer == Answer::NoMismatch && !is_beyond && times.is_finite(), "{case}");
                    }
                    if headline.contains("the residual is noise") {
                        assert!(answer == Answer::NoMismatch && !is_beyond, "{case}: {headline}");
                        assert!(tone != Tone::Found, "{case}");
                    }
                }
            }
        }
        assert!(ticks > 0);
    }
}
