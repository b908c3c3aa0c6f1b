use crate::effects::torque_constant;
use crate::evidence::problem::Problem;
use crate::hypotheses::candidates::Candidate;
use crate::hypotheses::group::{Group, Switch};
use crate::investigation::{Fitted, Investigation};
use crate::request::Question;
use crate::verdict::{open_rivals, share_left};
use crate::vocabulary::{Effect, Presence};

/// An effect, or a structure of drives, on some joints.
#[derive(Debug, Clone, Default)]
pub struct Subject {
    pub id: &'static str,
    pub joints: Vec<usize>,
    pub is_whole_arm: bool,
    /// Index of the candidate of an effect.
    pub(super) candidate: usize,
    pub(super) switches: Vec<Switch>,
}

impl Subject {
    /// The effect of a hypothesis.
    pub(super) fn of(group: &Group) -> Self {
        Self::of_effect(group.effect, &group.joints, group.candidate, group.switches.clone())
    }

    fn of_effect(effect: &Effect, joints: &[usize], candidate: usize, switches: Vec<Switch>) -> Self {
        let Effect { id, is_whole_arm, .. } = *effect;
        Self { id, joints: joints.to_vec(), is_whole_arm, candidate, switches }
    }
}

/// An open question of a diagnosis.
#[derive(Debug, Clone)]
pub enum Doubt {
    /// Another effect describes the recordings as well as a claim.
    Rivals {
        /// What is claimed.
        claimed: Subject,
        /// What does as well.
        rival: Subject,
    },
    /// An effect describes the recordings and fails a test: it may be there or not.
    Indicated(Subject),
    /// The model takes up the effect's torque in these motions, so that they can neither show nor exclude it.
    Absorbed(Subject),
    /// A parameter of a claim, or of a structure, is known less well than is wanted.
    Wide(Subject, DeviationGoal),
}

/// Explanations of the recordings that a doubt is between.
#[derive(Debug)]
pub(super) enum Contest {
    /// Two claims, each with everything else that is claimed.
    Rivals(Box<[Explanation; 2]>),
    /// The model with the effect and without it.
    Indicated(Box<[Explanation; 2]>),
    /// Columns of the other laws that the effect's torque may be taken for.
    Absorbed(Subject, Vec<Vec<Switch>>),
    Wide(Subject, DeviationGoal),
}

/// A standard deviation that a parameter shall have at most.
#[derive(Debug, Clone, PartialEq)]
pub struct DeviationGoal {
    /// Canonical name of the parameter.
    pub parameter: String,
    /// The deviation, in its unit.
    pub std: f64,
}

/// A model of the recordings: which coefficients, and their values.
#[derive(Debug, Clone)]
pub(super) struct ModelFit {
    pub(super) switches: Vec<Switch>,
    pub(super) coefficients: Vec<f64>,
}

/// A model of the recordings as the truth, and as a rival of the truth.
#[derive(Debug, Clone)]
pub(super) struct Explanation {
    /// The laws in the shapes that were estimated.
    pub(super) truth: ModelFit,
    /// The same with the law in question in all shapes in which it was proposed: another shape may suit the motion better.
    pub(super) rival: ModelFit,
}

impl ModelFit {
    fn new(problem: &Problem, switches: Vec<Switch>, weights: &[f64]) -> Self {
        let (coefficients, _) = problem.least_squares(&switches, weights);
        Self { switches, coefficients }
    }
}

impl Doubt {
    /// The candidates that it is about.
    pub(super) fn candidates(&self) -> Vec<usize> {
        match self {
            Self::Rivals { claimed, rival } => vec![claimed.candidate, rival.candidate],
            Self::Indicated(subject) | Self::Absorbed(subject) | Self::Wide(subject, _) => {
                vec![subject.candidate]
            }
        }
    }
}

/// All doubts of a diagnosis, those of claims first.
pub(super) fn doubts(
    question: &Question<'_>,
    investigation: &Investigation,
    fitted: &Fitted,
    wanted: &[DeviationGoal],
) -> Vec<(Doubt, Contest)> {
    let Investigation { problem, groups, selection, .. } = investigation;
    let of_group = |g: usize| Subject::of(&groups[g]);
    let explained = |of: &mut dyn Iterator<Item = usize>, law: Option<usize>| {
        let mut all: Vec<usize> = of.collect();
        let model = |of: &[usize]| {
            let switches = investigation.switches_of(of.iter().map(|g| &groups[*g]));
            ModelFit::new(problem, switches, &fitted.weights)
        };
        let truth = model(&all);
        all.extend(law.into_iter().flat_map(|law| other_shapes(investigation, law)));
        Explanation { truth, rival: model(&all) }
    };
    let mut found = Vec::new();
    let claimed = || selection.chosen.iter().map(|chosen| chosen.group);
    for (i, one) in selection.chosen.iter().enumerate() {
        let others = || claimed().enumerate().filter(move |(k, _)| *k != i).map(|(_, g)| g);
        if one.withheld.is_some() {
            // No motion tells a change from the friction of another day.
            if groups[one.group].target_only() {
                continue;
            }
            let explanations = [explained(&mut claimed(), Some(one.group)), explained(&mut others(), None)];
            found.push((Doubt::Indicated(of_group(one.group)), Contest::Indicated(Box::new(explanations))));
            continue;
        }
        for rival in open_rivals(investigation, one, fitted) {
            let explanations = [
                explained(&mut claimed(), Some(one.group)),
                explained(&mut others().chain([rival.group]), Some(rival.group)),
            ];
            let doubt = Doubt::Rivals { claimed: of_group(one.group), rival: of_group(rival.group) };
            found.push((doubt, Contest::Rivals(Box::new(explanations))));
        }
    }
    for indicated in &investigation.indicated {
        let group = indicated.chosen.group;
        if indicated.usual || !groups[group].is_named() || claimed().any(|g| g == group) {
            continue;
        }
        let explanations =
            [explained(&mut claimed().chain([group]), Some(group)), explained(&mut claimed(), None)];
        found.push((Doubt::Indicated(of_group(group)), Contest::Indicated(Box::new(explanations))));
    }
    for wanted in wanted {
        let has = |g: &usize| groups[*g].effect.parameter(&wanted.parameter).is_some();
        let subjects = claimed().filter(has).map(of_group);
        let both = |s: Subject| (Doubt::Wide(s.clone(), wanted.clone()), Contest::Wide(s, wanted.clone()));
        found.extend(subjects.map(both));
    }
    found.extend(absorbed(question, investigation));
    found
}

/// The same law on the same joints in the other shapes from which the search began.
fn other_shapes(investigation: &Investigation, law: usize) -> impl Iterator<Item = usize> + '_ {
    let Investigation { groups, candidates, .. } = investigation;
    let own = &groups[law];
    let is_other = move |(k, group): &(usize, &Group)| {
        let proposal = &candidates[group.candidate].proposal;
        let mut shapes = proposal.shapes.iter().zip(&proposal.starts);
        *k != law
            && group.effect == own.effect
            && group.joints == own.joints
            && group.target_only() == own.target_only()
            && !proposal.shapes.is_empty()
            && shapes.all(|(shape, start)| proposal.fixed.get(shape.name) == Some(start))
    };
    groups.iter().enumerate().filter(is_other).map(|(k, _)| k)
}

/// What the model absorbs in the present motions: of each effect and joint the candidate of which most is left.
fn absorbed(question: &Question<'_>, investigation: &Investigation) -> Vec<(Doubt, Contest)> {
    let target = investigation.problem.has_target();
    let mut most: Vec<(Subject, f64)> = Vec::new();
    for (index, candidate) in investigation.candidates.iter().enumerate() {
        let Some(share) = share_left(investigation, index) else { continue };
        let target_only = target && candidate.proposal.presence == Presence::Change;
        if candidate.proposal.presence == Presence::Change && !target {
            continue;
        }
        let (joints, columns) = (&candidate.proposal.joints, columns_of(candidate, target_only));
        let subject = Subject::of_effect(candidate.effect, joints, index, columns);
        let same =
            |(known, _): &&mut (Subject, f64)| known.id == subject.id && known.joints == subject.joints;
        match most.iter_mut().find(same) {
            Some(known) if known.1 >= share => {}
            Some(known) => *known = (subject, share),
            None => most.push((subject, share)),
        }
    }
    let hidden = most.into_iter().filter(|(_, share)| *share < question.selection.free_share);
    let both = |(subject, _): (Subject, f64)| {
        let contest = Contest::Absorbed(subject.clone(), rivals_of(investigation, &subject));
        (Doubt::Absorbed(subject), contest)
    };
    hidden.map(both).collect()
}

/// The coefficients of a candidate.
fn columns_of(candidate: &Candidate, target_only: bool) -> Vec<Switch> {
    let nonnegative = |k: usize| candidate.proposal.nonnegative.get(k).copied().unwrap_or(false);
    let switches = candidate.columns.iter().enumerate();
    switches.map(|(k, column)| Switch { column: *column, target_only, nonnegative: nonnegative(k) }).collect()
}

/// Laws for which a diagnosis may take the torque of another: those on its joint that are as simple, and gains of all joints, since the
/// model's bodies pass on to other joints what is wrong with the load of one. A more general law gives way, as in the search. The
/// same force by another name is no rival.
fn rivals_of(investigation: &Investigation, subject: &Subject) -> Vec<Vec<Switch>> {
    let target_only = subject.switches.first().is_some_and(|s| s.target_only);
    let freedoms = |c: &Candidate| c.columns.len() + c.proposal.shapes.len();
    let itself = &investigation.candidates[subject.candidate];
    let own = freedoms(itself);
    let is_rival = |other: &&Candidate| {
        let is_simple = other.columns.len() <= subject.switches.len() || freedoms(other) <= own;
        let meets = other.proposal.joints.iter().any(|j| subject.joints.contains(j));
        let is_tried = target_only || other.proposal.presence != Presence::Change;
        other.registered.is_none()
            && other.effect != itself.effect
            && !other.effect.is_same_force(itself.effect)
            && is_simple
            && is_tried
            && (meets || *other.effect == torque_constant::EFFECT)
    };
    let rivals = investigation.candidates.iter().filter(is_rival);
    rivals.map(|other| columns_of(other, target_only)).collect()
}
