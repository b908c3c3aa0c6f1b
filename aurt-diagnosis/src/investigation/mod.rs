//! The walk through all rooms, from recordings to what was found.

mod agreement;
mod common;
mod contacts;
mod delay_scan;
mod earned;
mod fitted;
mod gears;
mod late;
mod predicted;
mod repairs;
mod reselected;
mod reshaped;
mod selecting;
mod settled;
mod shifted;
mod unchanged;

pub use earned::Indicated;
pub(crate) use earned::{concerned, earn};
pub(crate) use fitted::Fitted;
pub use gears::BeforeGears;
pub(crate) use gears::WORSE;
pub use late::{Delay, Late};
pub(crate) use repairs::JudgedFaults;
use reselected::reselect;
pub(crate) use reshaped::reshape_judged;
pub(crate) use selecting::mean_floor;
use settled::load_noise;

use aurt_plugins::Registry;
use aurt_recording::BranchMotion;
use aurt_traits::{RigidBodyRegressor, RobotModel};
use rayon::prelude::*;

use crate::contact::Contact;
use crate::effects::external_contact;
use crate::effects::time_delay::EFFECT as DELAY;
use crate::error::DiagnosisError;
use crate::evidence::baseline::{BLOCKS, Baseline, GAP_PERIODS, extended_load, own_switches, partition};
use crate::evidence::deviations::memory;
use crate::evidence::judge::Judge;
use crate::evidence::judged::{Judged, bound_floors, prepare};
use crate::evidence::problem::Problem;
use crate::evidence::total::TotalFit;
use crate::faults::Fault;
use crate::hypotheses::candidates::{Candidate, candidates};
use crate::hypotheses::group::{Group, Switch};
use crate::hypotheses::registered;
use crate::noise::spectrum::RecordingNoise;
use crate::recordings::divided::{ConfirmRows, FitRows};
use crate::recordings::partition::Partition;
use crate::recordings::rows::{Fit, Layout, RecordingRows, Role};
use crate::request::{Question, QuestionedRecording, length};
use crate::search::selection::Selection;
use crate::transmission::{Shaking, VisibleGear};
use crate::vocabulary::Context;
use gears::{Elastic, beside_gears};
use selecting::{Parts, Selected};

/// Everything that a diagnosis has worked out, from which the verdict is written.
#[derive(Debug)]
pub struct Investigation {
    /// The model with the terms of every candidate.
    pub model: RobotModel,
    pub baseline: Baseline,
    /// The rows of all recordings that fit, search and mask.
    pub rows: FitRows,
    /// The rows that only judge what was found.
    pub confirm: ConfirmRows,
    /// Which of them fit and which judge.
    pub partition: Partition,
    /// Columns.
    pub layout: Layout,
    /// Second moments.
    pub problem: Problem,
    pub candidates: Vec<Candidate>,
    /// Hypotheses.
    pub groups: Vec<Group>,
    /// Coefficients that are always in the model.
    pub base_switches: Vec<Switch>,
    /// Noise floor, mean square, `[recording][joint]`.
    pub floors: Vec<Vec<f64>>,
    /// The noise of each recording under the baseline.
    pub noise: Vec<RecordingNoise>,
    /// Where the noise was estimated higher than what is left, in words.
    pub noise_notes: Vec<String>,
    /// Noise floor over the fitted rows, joint by joint.
    pub floor: Vec<f64>,
    /// Whether the calibration recordings leave open what the targets' motion needs, so that both were fitted together.
    pub undetermined: bool,
    /// Faults of the recordings.
    pub faults: Vec<Fault>,
    /// Whether their repair improves the fit of the model in question.
    pub faults_matter: bool,
    /// Gears that give way or have play; the torque of those that are confirmed was taken out of the measurement.
    pub shaking: Vec<Shaking>,
    /// The gears that would have shown, joint by joint.
    pub gears_visible: Vec<VisibleGear>,
    /// What the model left before that torque was taken out, if any was.
    pub before_gears: Option<BeforeGears>,
    /// The delay that was undone before everything else here, if any.
    pub late: Option<Late>,
    /// Contacts with the surroundings; their windows are left out of selection.
    pub contacts: Vec<Contact>,
    /// What selection found and what passed every test after it.
    pub selection: Selection,
    /// What selection found and what failed a test.
    pub indicated: Vec<Indicated>,
    /// Joints whose measurement never changes, by recording: (recording, joint, value).
    pub constant: Vec<(usize, usize, f64)>,
    /// Share of the measurement's variance that the model in question predicts on time that it was not fitted to, joint
    /// by joint; none where nothing was measured in motion.
    pub predicted: Vec<Option<f64>>,
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
        self.switches_of(self.selection.chosen.iter().map(|c| &self.groups[c.group]))
    }

    /// Judges what was selected on the rows that confirm.
    pub(crate) fn confirm_chosen(&mut self, question: &Question<'_>) {
        let switches = self.switches();
        let Self {
            selection,
            confirm,
            groups,
            layout,
            partition,
            problem,
            rows,
            floor,
            base_switches,
            mean_independent_share,
            ..
        } = self;
        let judge = Judge { problem, groups, rows, partition, layout, floor, options: &question.selection };
        // Four independent samples of white noise behind the parallel filter.
        let shortest_s = 1.0 / question.f_dyn_hz;
        let memory = memory(*mean_independent_share);
        for chosen in &mut selection.chosen {
            chosen.p_confirm = judge.p_confirm(
                confirm,
                (base_switches, &switches),
                &groups[chosen.group],
                (shortest_s, memory),
            );
        }
    }

    /// The baseline's coefficients and those of some groups.
    pub(crate) fn switches_of<'g>(&self, groups: impl Iterator<Item = &'g Group>) -> Vec<Switch> {
        let mut all = self.base_switches.clone();
        for switch in groups.flat_map(|g| &g.switches) {
            if !all.iter().any(|s| s.column == switch.column && s.target_only == switch.target_only) {
                all.push(*switch);
            }
        }
        all
    }
}

/// Investigates a question: baseline, candidates, selection, tests. A delay is undone before anything else is claimed, and gears
/// are looked for in what all claims leave: a delay or a load that a model lacks has torque at all frequencies, and
/// simulated links follow a part of it.
///
/// # Errors
/// What evaluation reports; [`DiagnosisError::NothingToDiagnose`].
pub fn investigate(
    question: &Question<'_>,
    registry: &Registry,
    mut progress: impl FnMut(&str),
) -> Result<Investigation, DiagnosisError> {
    let Punctual { mut examination, recordings: punctual, without } =
        punctual(question, registry, &mut progress)?;
    let question = &Question { recordings: &punctual, without: &without, ..*question };
    if examination.investigation.shaking.is_empty() {
        progress("testing the findings");
        let rigid = &Question { recordings: &examination.recordings, ..*question };
        earn(rigid, &mut examination.investigation)?;
        let late = examination.investigation.late.take();
        examination = beside_gears(question, registry, examination, &mut progress)?;
        examination.investigation.late = late;
    }
    let Examination { mut investigation, recordings } = examination;
    let question = &Question { recordings: &recordings, ..*question };
    reselect(question, registry, &mut investigation, progress)?;
    load_noise(question, registry, &mut investigation)?;
    Ok(investigation)
}

/// An investigation up to selection.
struct Examination {
    investigation: Investigation,
    /// The recordings as they were examined: repaired, and without the torque of gears.
    recordings: Vec<QuestionedRecording>,
}

/// An examination of measurements that come in time.
struct Punctual {
    examination: Examination,
    /// The recordings, a delay undone.
    recordings: Vec<QuestionedRecording>,
    /// Effects that are not looked for.
    without: Vec<String>,
}

/// Investigates up to selection, with a delay undone if there is one.
fn punctual(
    question: &Question<'_>,
    registry: &Registry,
    progress: &mut impl FnMut(&str),
) -> Result<Punctual, DiagnosisError> {
    let first = examine(question, registry, None, progress)?;
    let found = if question.considers(&DELAY) { Delay::found(question, &first.investigation)? } else { None };
    let mut without = question.without.to_vec();
    without.push(DELAY.id.to_owned());
    if found.is_none() && !first.investigation.is_late() {
        return Ok(Punctual { examination: first, recordings: question.recordings.to_vec(), without });
    }
    if found.is_some()
        && let Some(examination) =
            elastic_instead(&Question { without: &without, ..*question }, registry, progress)?
    {
        return Ok(Punctual { examination, recordings: question.recordings.to_vec(), without });
    }
    let recordings = match &found {
        Some(delay) => {
            progress("shifting the measurement back");
            delay.undone(question)?
        }
        // What the column of a delay described is something else.
        None => question.recordings.to_vec(),
    };
    let again = Question { recordings: &recordings, without: &without, ..*question };
    let mut examination = examine(&again, registry, None, progress)?;
    examination.investigation.late = found.map(|delay| Late { delay, before: Box::new(first.investigation) });
    Ok(Punctual { examination, recordings, without })
}

/// The examination of measurements whose delay is the lag of gears: beside those that are there, nothing is late any more. One
/// gear follows a part of a delay on its joint, and leaves that of the others.
fn elastic_instead(
    question: &Question<'_>,
    registry: &Registry,
    progress: &mut impl FnMut(&str),
) -> Result<Option<Examination>, DiagnosisError> {
    let mut rigid = examine(question, registry, None, progress)?;
    earn(&Question { recordings: &rigid.recordings, ..*question }, &mut rigid.investigation)?;
    let elastic = beside_gears(question, registry, rigid, progress)?;
    if elastic.investigation.shaking.iter().all(|g| !g.confirmed) {
        return Ok(None);
    }
    let freed = &Question { recordings: &elastic.recordings, ..*question };
    Ok(Delay::found(freed, &elastic.investigation)?.is_none().then_some(elastic))
}

/// The travel of each joint below which positions are not told apart in the coarsest recording: the step of the encoder,
/// and three deviations of the noise beside it.
fn resolution_rad(noise: &[RecordingNoise], joints: usize) -> Vec<f64> {
    let of = |recording: &RecordingNoise, joint: usize| {
        let position = recording.positions.get(joint);
        position.map_or(0.0, |p| p.step_rad.unwrap_or(0.0).max(3.0 * p.white_rad))
    };
    (0..joints).map(|j| noise.iter().map(|r| of(r, j)).fold(0.0, f64::max)).collect()
}

/// Pairs of joints that no link loads both of, the first before the second.
fn apart(body: &dyn RigidBodyRegressor) -> Vec<[usize; 2]> {
    let (joints, parameters) = (body.joints(), body.standard_parameters().len());
    let together =
        |j, k| (0..parameters).any(|parameter| body.loads(parameter, j) && body.loads(parameter, k));
    let pairs = (0..joints).flat_map(|j| (j + 1..joints).map(move |k| [j, k]));
    pairs.filter(|[j, k]| !together(*j, *k)).collect()
}

/// Investigates recordings as they are up to selection, without the torque of gears.
fn examine(
    question: &Question<'_>,
    registry: &Registry,
    elastic: Option<&Elastic>,
    progress: &mut impl FnMut(&str),
) -> Result<Examination, DiagnosisError> {
    if question.recordings.iter().all(|r| r.role == Role::Validation) {
        return Err(DiagnosisError::NothingToDiagnose);
    }
    length::check(question, BLOCKS, GAP_PERIODS / question.f_dyn_hz)?;
    progress("looking for faults of the recordings");
    let first = question.recordings.first();
    for recording in question.recordings {
        let [own, other] = [Some(recording), first].map(|r| r.map_or(&[][..], |r| &r.raw.report.branches));
        if let Some(branch) = BranchMotion::elsewhere(own, other) {
            let (recording, branch) = (recording.data.name.clone(), branch.clone());
            return Err(DiagnosisError::Branch { recording, branch });
        }
    }
    let repaired = |r: &QuestionedRecording| r.repaired(question.without);
    let recordings = question.recordings.iter().map(repaired).collect::<Result<Vec<_>, _>>()?;
    let constant = constant_joints(&recordings);
    let as_recorded = question;
    let question = &Question { recordings: &recordings, ..*question };
    let JudgedFaults { faults, matter: faults_matter } = JudgedFaults::new(as_recorded, question)?;
    let recordings = match elastic {
        Some(elastic) => elastic.undone(question)?,
        None => recordings,
    };
    let question = &Question { recordings: &recordings, ..*as_recorded };
    progress("fitting the reference model");
    let mut judged = Judged::new(question, Baseline::new(question)?)?;
    // A model that the calibration recordings do not determine says nothing of the targets' motion: of parameters that
    // these alone excite, noise decides.
    let undetermined = !judged.baseline.frozen && judged.noise_exceeds_all;
    if undetermined {
        judged = Judged::new(question, Baseline::of_all(question)?)?;
    }
    let shaking = elastic.map_or_else(Vec::new, |e| e.gears.found.clone());
    let gears_visible = elastic.map_or_else(Vec::new, |e| e.gears.visible.clone());
    let before_gears = elastic.map(|e| e.before.clone());
    let Judged { baseline, own_rows, mut floors, noise, notes: mut noise_notes, .. } = judged;
    if let Some(k) = baseline.coefficients.iter().position(|c| !c.is_finite()) {
        let figure = format!("coefficient {k} of the model in question");
        return Err(DiagnosisError::NotFinite { figure });
    }
    let own_partition = partition(question, &own_rows);
    let (own_rows, _) = FitRows::divide(own_rows, &own_partition);
    let inertial: Vec<(usize, f64)> =
        question.model.base().columns.iter().copied().zip(baseline.coefficients.iter().copied()).collect();

    progress("making candidates");
    let simulated: Vec<usize> = shaking.iter().filter(|s| s.confirmed).map(|s| s.joint).collect();
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
    let predicted = predicted::shares(question, &baseline, &own_rows, &own_partition);
    let fitted: Vec<usize> = (0..own_rows.len()).filter(|r| own_rows[*r].role != Role::Validation).collect();
    // Effects propose by motions; the columns of the rows are what takes the memory.
    let context_rows: Vec<RecordingRows> = fitted.iter().map(|r| own_rows[*r].without_columns()).collect();
    drop(own_rows);
    let context_residual: Vec<Vec<Vec<f64>>> = fitted.iter().map(|r| residual[*r].clone()).collect();
    let context = Context {
        joints: question.model.joints(),
        links: question.model.rigid_body().bodies().len(),
        apart: &apart(&**question.model.rigid_body()),
        recordings: &context_rows,
        residual: &context_residual,
        inertial: &inertial,
        resolution_rad: &resolution_rad(&noise, question.model.joints()),
    };
    let (proposed, untried) = registered::proposals(question, registry);
    let (model, mut candidates) = candidates(question, registry, &context, proposed, &simulated)?;
    drop(context_rows);

    progress("evaluating candidates");
    let load = extended_load(&baseline, question.model, &model);
    let own = Fit { model: question.model, load: &baseline.load, coefficients: &baseline.coefficients };
    let of_recording = |recording: &QuestionedRecording| {
        let (name, data) = (&recording.data.name, &recording.data.data);
        let mut own_and_candidates =
            RecordingRows::evaluate(name, recording.role, data, &model, &load, &own)?;
        recording.mask(&mut own_and_candidates);
        Ok(own_and_candidates)
    };
    let mut rows =
        question.recordings.par_iter().map(of_recording).collect::<Result<Vec<_>, DiagnosisError>>()?;
    prepare(question, &baseline, &model, &mut rows);
    let partition = partition(question, &rows);
    let (mut rows, mut confirm) = FitRows::divide(rows, &partition);
    let layout = Layout::new(&model);
    let base_switches = if baseline.frozen { Vec::new() } else { own_switches(question.model) };
    let mut floor = mean_floor(&rows, &partition, &floors, |_| true);
    let mut parts = Parts {
        question,
        registry,
        candidates: &mut candidates,
        partition: &partition,
        layout: &layout,
        base: &base_switches,
        own: &baseline.coefficients,
        floor: &floor,
    };
    let mut selected = parts.select(&mut rows, progress);
    let mut contacts = Vec::new();
    if question.considers(&external_contact::EFFECT) {
        progress("looking for contacts");
        // A few periods of a ringing gear push like a hand.
        let shortest_s = shaking
            .iter()
            .filter(|s| s.confirmed)
            .map(|s| RINGS_PERIODS / s.frequency_hz)
            .fold(0.0, f64::max);
        (contacts, selected) = parts.with_contacts(&mut rows, selected, shortest_s, progress)?;
        contacts.extend(parts.standing_contacts(&model, &baseline, &rows, &selected)?);
    }
    progress("refining effects that depend on the model's torque");
    if parts.settle(&baseline, &mut rows, &mut confirm, &mut selected)? {
        selected = parts.select(&mut rows, progress);
    }
    let chosen = selected.selection.chosen.iter().map(|c| selected.groups[c.group].candidate);
    reshape_judged(&mut confirm, parts.candidates, chosen, question, registry, &layout, &partition)?;
    parts.settle(&baseline, &mut rows, &mut confirm, &mut selected)?;
    let Selected {
        problem,
        groups,
        free,
        selection,
        fitted: Fitted { switches, fit: TotalFit { coefficients, .. }, .. },
        mean_independent_share,
    } = selected;
    noise_notes.extend(bound_floors(&rows, &layout, &switches, &coefficients, &mut floors, question.names()));
    floor = mean_floor(&rows, &partition, &floors, |_| true);
    let mut investigation = Investigation {
        model,
        baseline,
        rows,
        confirm,
        partition,
        layout,
        problem,
        candidates,
        groups,
        base_switches,
        floors,
        noise,
        noise_notes,
        floor,
        faults,
        faults_matter,
        undetermined,
        late: None,
        shaking,
        gears_visible,
        before_gears,
        contacts,
        selection,
        indicated: Vec::new(),
        constant,
        predicted,
        untried,
        free,
        mean_independent_share,
    };
    investigation.confirm_chosen(question);
    Ok(Examination { investigation, recordings })
}

/// Where a gear rings, contacts shorter than this many of its periods are its ringing.
const RINGS_PERIODS: f64 = 6.0;

/// Joints whose measurement never changes: (recording, joint, value).
fn constant_joints(recordings: &[QuestionedRecording]) -> Vec<(usize, usize, f64)> {
    let of_recording = |(r, recording): (usize, &QuestionedRecording)| {
        let spoilt = recording.spoilt.iter().flat_map(|s| s.constant.iter().enumerate());
        spoilt.filter_map(move |(joint, value)| Some((r, joint, (*value)?))).collect::<Vec<_>>()
    };
    recordings.iter().enumerate().flat_map(of_recording).collect()
}
