//! The walk through all rooms, from recordings to what was found.

mod gears;
mod late;

pub use gears::BeforeGears;
pub use late::{Delay, Late};

use aurt_plugins::Registry;
use aurt_traits::RobotModel;

use crate::contact::{Contact, ContactOptions, ContactRows, find_contacts, force_columns};
use crate::error::DiagnosisError;
use crate::evidence::baseline::{
    Baseline, evaluate_all, extended_load, own_switches, partition, weighted_fit,
};
use crate::evidence::decidable::groups;
use crate::evidence::gram::BlockMoments;
use crate::evidence::judged::{Judged, prepare};
use crate::evidence::problem::Problem;
use crate::evidence::residuals::{residuals, shares};
use crate::hypotheses::candidates::{Candidate, candidates};
use crate::hypotheses::effects::Context;
use crate::hypotheses::group::{Group, Switch};
use crate::recordings::faults::Fault;
use crate::recordings::partition::Partition;
use crate::recordings::rows::{Fit, Layout, RecordingRows, Role};
use crate::request::{Question, QuestionedRecording};
use crate::search::selection::{Selection, Selector};
use crate::transmission::Shaking;
use crate::{hypotheses::registered, search};
use gears::without_gears;
use late::Found;

/// Everything that a diagnosis has worked out, from which the verdict is written.
#[derive(Debug)]
pub struct Investigation {
    /// The model with the terms of every candidate.
    pub model: RobotModel,
    /// The baseline.
    pub baseline: Baseline,
    /// The rows of all recordings.
    pub rows: Vec<RecordingRows>,
    /// Which of them fit and which judge.
    pub partition: Partition,
    /// Columns.
    pub layout: Layout,
    /// Second moments.
    pub problem: Problem,
    /// Candidates.
    pub candidates: Vec<Candidate>,
    /// Hypotheses.
    pub groups: Vec<Group>,
    /// Coefficients that are always in the model.
    pub base_switches: Vec<Switch>,
    /// Noise floor, mean square, `[recording][joint]`.
    pub floors: Vec<Vec<f64>>,
    /// Noise floor over the fitted rows, joint by joint.
    pub floor: Vec<f64>,
    /// Log of the ratio by which the baseline's error on the calibration recordings exceeds the floor, joint by joint.
    pub misfit: Vec<f64>,
    /// Whether the calibration recordings leave open what the targets' motion needs, so that both were fitted together.
    pub undetermined: bool,
    /// Faults of the recordings.
    pub faults: Vec<Fault>,
    /// Whether their repair improves the fit of the model in question.
    pub faults_matter: bool,
    /// Gears that give way or have play; the torque of those that are confirmed was taken out of the measurement.
    pub shaking: Vec<Shaking>,
    /// From which stiffness and play on gears would have shown, in sentences.
    pub gears_not_seen: Vec<String>,
    /// What the model left before that torque was taken out, if any was.
    pub before_gears: Option<BeforeGears>,
    /// The delay that was undone before everything else here, if any.
    pub late: Option<Late>,
    /// Contacts with the surroundings; their windows took no part in selection.
    pub contacts: Vec<Contact>,
    /// What selection found.
    pub selection: Selection,
    /// Registered models that could not be tried, and why.
    pub untried: Vec<String>,
    /// Share of each candidate's torque that the baseline cannot absorb: in all recordings, in targets only.
    pub free: Vec<[f64; 2]>,
    /// Share of independent rows of the final residual, mean over joints.
    pub mean_independent_share: f64,
}

impl Investigation {
    /// Coefficients of the final model: the baseline's and those of what was selected.
    pub(crate) fn switches(&self) -> Vec<Switch> {
        let mut all = self.base_switches.clone();
        for switch in self.selection.chosen.iter().flat_map(|c| &self.groups[c.group].switches) {
            if !all.iter().any(|s| s.column == switch.column && s.target_only == switch.target_only) {
                all.push(*switch);
            }
        }
        all
    }
}

/// Investigates a question: baseline, candidates, selection. Where the measurement turns out to be late, it is
/// shifted back and everything investigated again, so that the delay distorts no other finding.
///
/// # Errors
/// What evaluation reports; [`DiagnosisError::NothingToDiagnose`].
pub fn investigate(
    question: &Question<'_>,
    registry: &Registry,
    mut progress: impl FnMut(&str),
) -> Result<Investigation, DiagnosisError> {
    let mut first = investigate_as_it_is(question, registry, true, &mut progress)?;
    let mut found = Delay::found(&first);
    if matches!(found, Found::OnlyFriction) {
        first = investigate_as_it_is(question, registry, false, &mut progress)?;
        found = Delay::found(&first);
    }
    if matches!(found, Found::FewJoints) {
        let mut without = question.without.to_vec();
        without.push("time_delay".to_owned());
        let question = Question { without: &without, ..*question };
        return investigate_as_it_is(&question, registry, false, &mut progress);
    }
    let Found::Delay(delay) = found else { return Ok(first) };
    progress("shifting the measurement back");
    let shifted = delay.undone(question)?;
    let mut without = question.without.to_vec();
    without.push("time_delay".to_owned());
    let question = Question { recordings: &shifted, without: &without, ..*question };
    let mut second = investigate_as_it_is(&question, registry, true, &mut progress)?;
    second.late = Some(Late { delay, before: Box::new(first) });
    Ok(second)
}

/// Investigates recordings as they are.
fn investigate_as_it_is(
    question: &Question<'_>,
    registry: &Registry,
    friction_may_be_late: bool,
    progress: &mut impl FnMut(&str),
) -> Result<Investigation, DiagnosisError> {
    if question.recordings.iter().all(|r| r.role == Role::Validation) {
        return Err(DiagnosisError::NothingToDiagnose);
    }
    progress("looking for faults of the recordings");
    let recordings =
        question.recordings.iter().map(QuestionedRecording::repaired).collect::<Result<Vec<_>, _>>()?;
    let faults: Vec<Fault> =
        recordings.iter().filter_map(|r| r.spoilt.as_ref()).flat_map(|s| s.faults.faults.clone()).collect();
    let as_recorded = question;
    let question = &Question { recordings: &recordings, ..*question };
    let faults_matter = faults.iter().any(|f| f.suffices) && repair_helps(as_recorded, question)?;
    progress("fitting the model in question");
    let mut judged = Judged::new(question, Baseline::new(question)?)?;
    // A model that the calibration recordings do not determine says nothing of the targets' motion: of parameters that
    // these alone excite, noise decides.
    let undetermined = !judged.baseline.frozen && judged.noise_exceeds_all();
    if undetermined {
        judged = Judged::new(question, Baseline::of_all(question)?)?;
    }
    progress("simulating links on their gears");
    let gears = without_gears(question, judged, undetermined)?;
    let freed =
        Question { recordings: gears.recordings.as_deref().unwrap_or(question.recordings), ..*question };
    let question = &freed;
    let (shaking, gears_not_seen, before_gears) = (gears.gears.found, gears.gears.not_seen, gears.before);
    let Judged { baseline, own_rows, floors } = gears.judged;
    let inertial: Vec<(usize, f64)> =
        question.model.base().columns.iter().copied().zip(baseline.coefficients.iter().copied()).collect();

    progress("making candidates");
    let residual: Vec<Vec<Vec<f64>>> = own_rows
        .iter()
        .map(|r| {
            r.joints
                .iter()
                .enumerate()
                .map(|(j, joint)| {
                    let columns = question.model.row_columns(j);
                    joint.residual(
                        columns.iter().map(|c| if baseline.frozen { 0.0 } else { baseline.coefficients[*c] }),
                    )
                })
                .collect()
        })
        .collect();
    let fitted: Vec<usize> = (0..own_rows.len()).filter(|r| own_rows[*r].role != Role::Validation).collect();
    let context_rows: Vec<RecordingRows> = fitted.iter().map(|r| own_rows[*r].clone()).collect();
    let context_residual: Vec<Vec<Vec<f64>>> = fitted.iter().map(|r| residual[*r].clone()).collect();
    let context = Context {
        joints: question.model.joints(),
        recordings: &context_rows,
        residual: &context_residual,
        inertial: &inertial,
    };
    let unasked = |effect: &str| question.without.iter().any(|w| w == effect);
    let (proposed, untried) = registered::proposals(question, registry);
    let (model, candidates) =
        candidates(question, registry, &context, friction_may_be_late, unasked, proposed)?;
    drop(context_rows);

    progress("evaluating candidates");
    let load = extended_load(&baseline, question.model, &model);
    let mut rows = Vec::new();
    for recording in question.recordings {
        let own = Fit { model: question.model, load: &baseline.load, coefficients: &baseline.coefficients };
        let (name, data) = (&recording.data.name, &recording.data.data);
        let mut own_and_candidates =
            RecordingRows::evaluate(name, recording.role, data, &model, &load, &own)?;
        recording.mask(&mut own_and_candidates);
        rows.push(own_and_candidates);
    }
    prepare(question, &baseline, &model, &mut rows);
    let partition = partition(question, &rows);
    let layout = Layout::new(&model);
    let base_switches = if baseline.frozen { Vec::new() } else { own_switches(question.model) };
    let floor = mean_floor(&rows, &partition, &floors);
    let parts = Parts {
        question,
        candidates: &candidates,
        partition: &partition,
        layout: &layout,
        base: &base_switches,
        floor: &floor,
    };
    let mut selected = parts.select(&rows, progress);
    progress("looking for contacts");
    let mut contacts = parts.contacts(&rows, &selected)?;
    // A few periods of a ringing gear push like a hand.
    let shortest_s =
        shaking.iter().filter(|s| s.confirmed).map(|s| RINGS_PERIODS / s.frequency_hz).fold(0.0, f64::max);
    contacts.retain(|c| c.window_s[1] - c.window_s[0] > shortest_s);
    if !contacts.is_empty() {
        for contact in &contacts {
            leave_out(&mut rows[contact.recording], contact.window_s);
        }
        selected = parts.select(&rows, progress);
    }
    let Selected { problem, groups, free, selection, mean_independent_share, misfit, .. } = selected;
    Ok(Investigation {
        model,
        baseline,
        rows,
        partition,
        layout,
        problem,
        candidates,
        groups,
        base_switches,
        floors,
        floor,
        misfit,
        faults,
        faults_matter,
        undetermined,
        late: None,
        shaking,
        gears_not_seen,
        before_gears,
        contacts,
        selection,
        untried,
        free,
        mean_independent_share,
    })
}

/// Where a gear rings, contacts shorter than this many of its periods are its ringing.
const RINGS_PERIODS: f64 = 6.0;

/// A repair matters if it lowers the mean squared residual of some joint by this share.
const REPAIRED: f64 = 0.1;

/// Whether the model in question fits the repaired recordings better than the recordings as they were made.
fn repair_helps(as_recorded: &Question<'_>, repaired: &Question<'_>) -> Result<bool, DiagnosisError> {
    let (before, after) = (mean_squares(as_recorded)?, mean_squares(repaired)?);
    Ok(before.iter().zip(&after).any(|(before, after)| *after < (1.0 - REPAIRED) * before))
}

/// Mean squared residual of each joint under the model in question, over what is not for validation.
fn mean_squares(question: &Question<'_>) -> Result<Vec<f64>, DiagnosisError> {
    let baseline = Baseline::new(question)?;
    let fit = Fit { model: question.model, load: &baseline.load, coefficients: &baseline.coefficients };
    let mut rows = evaluate_all(question, question.model, &fit)?;
    prepare(question, &baseline, question.model, &mut rows);
    let asked: Vec<&RecordingRows> = rows.iter().filter(|r| r.role != Role::Validation).collect();
    let joints = question.model.joints();
    Ok((0..joints)
        .map(|j| {
            let columns = question.model.row_columns(j);
            let value = |c: &usize| if baseline.frozen { 0.0 } else { baseline.coefficients[*c] };
            let (sum, count) = asked.iter().fold((0.0, 0.0), |(sum, count), r| {
                let residual = r.joints[j].residual(columns.iter().map(value));
                let power: f64 = residual.iter().map(|e| e * e).sum();
                (sum + power, count + r.joints[j].counted(0, r.rows()))
            });
            sum / f64::max(count, 1.0)
        })
        .collect())
}

/// What selection works on, beside the rows.
struct Parts<'a> {
    question: &'a Question<'a>,
    candidates: &'a [Candidate],
    partition: &'a Partition,
    layout: &'a Layout,
    base: &'a [Switch],
    floor: &'a [f64],
}

/// A selection and what it was made from.
struct Selected {
    problem: Problem,
    groups: Vec<Group>,
    free: Vec<[f64; 2]>,
    selection: Selection,
    switches: Vec<Switch>,
    coefficients: Vec<f64>,
    mean_independent_share: f64,
    misfit: Vec<f64>,
}

impl Parts<'_> {
    fn select(&self, rows: &[RecordingRows], progress: &mut impl FnMut(&str)) -> Selected {
        let problem = Problem::new(self.layout, BlockMoments::accumulate(rows, self.partition));
        let (_, weights) = weighted_fit(&problem, self.base, self.floor);
        let (groups, free) = groups(self.candidates, &problem, self.base, &weights, self.question);
        progress("selecting");
        let shares = |switches: &[Switch], coefficients: &[f64]| {
            shares(rows, self.partition, self.layout, switches, coefficients)
        };
        let misfit = misfit(&problem, self.base, &weights, self.floor);
        let mut select = |groups: &[Group]| {
            let selector = Selector {
                problem: &problem,
                baseline: self.base,
                groups,
                floor: self.floor,
                misfit: &misfit,
                independent_share: &shares,
                options: &self.question.selection,
            };
            let selection = search::registered::choose(&selector, groups, &mut *progress);
            let switches = selector.final_switches(&selection);
            let (fit, _) = weighted_fit(&problem, &switches, self.floor);
            (selection, switches, fit.coefficients)
        };
        let (selection, switches, coefficients) = select(&groups);
        let final_shares = shares(&switches, &coefficients);
        let mean_independent_share = final_shares.iter().sum::<f64>() / final_shares.len().max(1) as f64;
        Selected { problem, groups, free, selection, switches, coefficients, mean_independent_share, misfit }
    }

    /// Contacts in the recordings that are not for validation, after all that was selected.
    fn contacts(&self, rows: &[RecordingRows], selected: &Selected) -> Result<Vec<Contact>, DiagnosisError> {
        let asked: Vec<usize> = (0..rows.len()).filter(|r| rows[*r].role != Role::Validation).collect();
        let body = self.question.model.rigid_body();
        let mut searched = Vec::new();
        for r in &asked {
            let left = residuals(&rows[*r], self.layout, &selected.switches, &selected.coefficients);
            // What is held out takes no part here either.
            let end = self.partition.fitted().filter(|p| p.0 == *r).map(|p| p.2).max().unwrap_or(0);
            let excluded = |(k, counts): (usize, &bool)| !counts || k >= end;
            let out: Vec<Vec<bool>> =
                rows[*r].joints.iter().map(|j| j.counts.iter().enumerate().map(excluded).collect()).collect();
            searched.push((left, out, force_columns(&**body, &rows[*r])?));
        }
        let views: Vec<ContactRows<'_>> = asked
            .iter()
            .zip(&searched)
            .map(|(r, (residual, left_out, forces))| ContactRows {
                rows: &rows[*r],
                origin_s: self.question.recordings[*r].raw.time_s.first().copied().unwrap_or(0.0),
                residual,
                forces,
                left_out,
            })
            .collect();
        let mut found = find_contacts(&views, &ContactOptions::new(self.question.f_dyn_hz));
        for contact in &mut found {
            contact.recording = asked[contact.recording];
        }
        Ok(found)
    }
}

/// Leaves out the rows of a window, s from the first row.
fn leave_out(rows: &mut RecordingRows, window_s: [f64; 2]) {
    let start = rows.time_s.first().copied().unwrap_or(0.0);
    let window_s = window_s.map(|t| t + start);
    let within: Vec<bool> = rows.time_s.iter().map(|t| (window_s[0]..=window_s[1]).contains(t)).collect();
    for joint in &mut rows.joints {
        for (counts, within) in joint.counts.iter_mut().zip(&within) {
            *counts &= !within;
        }
        joint.silence();
    }
}

/// Log of the ratio by which the baseline's cross-validated error on the calibration recordings exceeds the noise
/// floor; zero where there are none.
fn misfit(problem: &Problem, base: &[Switch], weights: &[f64], floor: &[f64]) -> Vec<f64> {
    let errors = problem.held_out(&problem.nest(base, weights), &[]);
    (0..problem.joints())
        .map(|j| {
            let rows = problem.rows(j, false) - problem.rows(j, true);
            if rows < 1.0 {
                0.0
            } else {
                (errors[0][j] / rows / floor[j].max(f64::MIN_POSITIVE)).ln().max(0.0)
            }
        })
        .collect()
}

/// Mean noise floor over the fitted rows.
fn mean_floor(rows: &[RecordingRows], partition: &Partition, floors: &[Vec<f64>]) -> Vec<f64> {
    let joints = rows.first().map_or(0, |r| r.joints.len());
    (0..joints)
        .map(|j| {
            let (sum, count) = partition.fitted().fold((0.0, 0.0), |(sum, count), (r, start, end)| {
                let counted = rows[r].joints[j].counted(start, end);
                (sum + floors[r][j] * counted, count + counted)
            });
            sum / f64::max(count, 1.0)
        })
        .collect()
}
