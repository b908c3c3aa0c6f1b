use aurt_plugins::Registry;
use aurt_recording::{PreprocessOptions, Recording, preprocess};

use crate::contact::{ForceColumns, force_columns};
use crate::error::DiagnosisError;
use crate::evidence::baseline::{own_switches, weighted_fit};
use crate::evidence::chance::Chance;
use crate::evidence::judge::Judge;
use crate::evidence::problem::Problem;
use crate::evidence::residuals::{residuals, shares};
use crate::hypotheses::group::{Group, Switch};
use crate::investigation::{Investigation, investigate};
use crate::noise::floor::noise_floor;
use crate::request::{Question, QuestionedRecording};
use crate::verdict::{Verdict, write_verdict};

/// What is added to the rows of the recordings, `[recording][joint][row]`, in the order of the question's recordings.
pub type AddedRows = Vec<Vec<Vec<f64>>>;

/// A question and all that a trial does not change.
#[derive(Debug)]
pub struct Prepared<'a> {
    pub(super) question: &'a Question<'a>,
    pub(super) registry: &'a Registry,
    /// The recordings as they were investigated: repaired, and shifted where they are late.
    pub(super) recordings: Vec<QuestionedRecording>,
    pub(super) reference: Investigation,
    verdict: Verdict,
    /// The best scores that chance reaches.
    pub(super) chance: Chance,
    /// Share of independent rows of what the final model leaves, joint by joint.
    pub(super) shares: Vec<f64>,
    /// What noise leaves, before it is bounded by what a model leaves, `[recording][joint]`.
    pub(super) floors: Vec<Vec<f64>>,
    /// Columns of the links' forces over the rows that fit, by recording.
    pub(super) forces: Vec<Vec<ForceColumns>>,
    /// Coefficients of the model in question, fitted as [`own_coefficients`] does.
    pub(super) own: Vec<f64>,
    /// What the final model leaves of the rows that fit, and of those that confirm, `[recording][joint][row]`.
    pub(super) left: [AddedRows; 2],
}

impl<'a> Prepared<'a> {
    /// Investigates the recordings as they are.
    ///
    /// # Errors
    /// As [`investigate`].
    pub fn new(
        question: &'a Question<'a>,
        registry: &'a Registry,
        progress: impl FnMut(&str),
    ) -> Result<Self, DiagnosisError> {
        let reference = investigate(question, registry, progress)?;
        let verdict = write_verdict(question, &reference);
        let shifted = reference.late.as_ref().map(|late| late.delay.undone(question)).transpose()?;
        let recordings = shifted
            .as_deref()
            .unwrap_or(question.recordings)
            .iter()
            .map(|r| r.repaired(question.without))
            .collect::<Result<Vec<_>, _>>()?;
        let switches = reference.switches();
        let fit = weighted_fit(&reference.problem, &switches, &reference.floor).0;
        let judge = Judge {
            problem: &reference.problem,
            groups: &reference.groups,
            rows: &reference.rows,
            partition: &reference.partition,
            layout: &reference.layout,
            floor: &reference.floor,
            options: &question.selection,
        };
        let shares =
            shares(&reference.rows, &reference.partition, &reference.layout, &switches, &fit.coefficients);
        let chance = judge.scores_by_chance(&switches, &shares);
        let mut floors = Vec::new();
        for (r, noise) in reference.noise.iter().enumerate() {
            let whole = reference.rows[r].followed_by(&reference.confirm.to_judge()[r]);
            floors.push(noise_floor(noise, &recordings[r].data.data, &whole)?);
        }
        let body = question.model.rigid_body();
        let forces =
            reference.rows.iter().map(|rows| force_columns(&**body, rows)).collect::<Result<Vec<_>, _>>()?;
        let left = [&reference.rows[..], reference.confirm.to_judge()].map(|all| {
            let of = |rows| residuals(rows, &reference.layout, &switches, &fit.coefficients);
            all.iter().map(of).collect::<Vec<_>>()
        });
        let own = own_coefficients(question, &reference, &reference.problem);
        Ok(Self {
            question,
            registry,
            recordings,
            verdict,
            chance,
            shares,
            floors,
            forces,
            own,
            left,
            reference,
        })
    }

    /// What is said of the recordings as they are.
    pub const fn verdict(&self) -> &Verdict {
        &self.verdict
    }

    /// The question about the recordings as they were investigated.
    pub(super) fn asked(&self) -> Question<'_> {
        Question { recordings: &self.recordings, ..*self.question }
    }

    /// The rows of a torque (or current) that is added to a recording's measurement, `[joint][sample]` at its own stamps,
    /// through the filters of the measurement: `[joint][row]`.
    ///
    /// # Errors
    /// What preprocessing reports.
    pub fn rows_of(&self, recording: usize, torque: Vec<Vec<f64>>) -> Result<Vec<Vec<f64>>, DiagnosisError> {
        let seen = &self.recordings[recording];
        let original = seen.spoilt.as_ref().map_or(&seen.raw, |s| &s.original);
        let added = Recording { measurement: Some(torque), ..(**original).clone() };
        let repaired = seen.spoilt.as_ref().and_then(|s| s.faults.repaired(&added));
        // An offset is of the measurement as a whole.
        let options = PreprocessOptions { offsets: None, ..seen.options.clone() };
        let mut data = preprocess(repaired.as_ref().unwrap_or(&added), &options)?;
        for (segment, of_seen) in data.segments.iter_mut().zip(&seen.data.data.segments) {
            if of_seen.left_out.is_some() {
                segment.leave_out(of_seen.left_out.clone())?;
            }
        }
        let mut rows = vec![Vec::new(); self.question.model.joints()];
        for segment in &data.segments {
            for (all, series) in rows.iter_mut().zip(segment.measurement.iter().flatten()) {
                all.extend_from_slice(series);
            }
        }
        Ok(rows)
    }

    /// Nothing that is added to any recording.
    pub fn nothing(&self) -> AddedRows {
        let confirm = self.reference.confirm.to_judge();
        let rows = |r: usize| self.reference.rows[r].rows() + confirm[r].rows();
        (0..self.recordings.len()).map(|r| vec![vec![0.0; rows(r)]; self.question.model.joints()]).collect()
    }

    /// Hypotheses of a trial in which the measurement of some joints changes: what is claimed of the recordings as they are,
    /// and what is about those joints. The places of the former are returned, too.
    pub(super) fn hypotheses(&self, joints: &[usize]) -> (Vec<Group>, Vec<usize>) {
        let known = |g: usize| self.reference.selection.chosen.iter().any(|c| c.group == g);
        let (mut groups, mut chosen) = (Vec::new(), Vec::new());
        for (g, group) in self.reference.groups.iter().enumerate() {
            if known(g) {
                chosen.push(groups.len());
            } else if !group.is_named() || !group.joints.iter().any(|j| joints.contains(j)) {
                continue;
            }
            groups.push(group.clone());
        }
        (groups, chosen)
    }
}

/// Coefficients of the model in question under a problem's measurement: those of the calibration recordings where there are
/// any, and the targets have theirs beside them.
pub(super) fn own_coefficients(
    question: &Question<'_>,
    investigation: &Investigation,
    problem: &Problem,
) -> Vec<f64> {
    let mut switches = own_switches(question.model);
    let own = switches.len();
    if !(problem.has_reference() && problem.has_target()) || investigation.undetermined {
        return weighted_fit(problem, &switches, &[]).0.coefficients;
    }
    let of_targets = |s: &Switch| Switch { target_only: true, ..*s };
    switches.extend(switches.clone().iter().map(of_targets));
    // The joints' weights are of the calibration recordings alone.
    let (_, [errors, _]) = problem.least_squares(&switches, &vec![1.0; problem.joints()]);
    let weights: Vec<f64> = (0..problem.joints())
        .map(|j| (problem.rows(j, false) - problem.rows(j, true)).max(1.0) / errors[j].max(f64::MIN_POSITIVE))
        .collect();
    let mut coefficients = problem.fit(&switches, &weights).coefficients;
    coefficients.truncate(own);
    coefficients
}
