//! What the drives and joints of a model have too much or too little, judged in the space of positions.
//!
//! # Steps
//! 1. The numbers are estimated from the fitted recordings; rollouts of the held-out ones are its predictions.
//! 2. Every structure that the model lacks is added on all joints it can concern, or its given numbers are estimated, and all
//!    numbers are estimated again. One is *missing*, or what is given of it *wrong*, if the held-out recordings are predicted
//!    better: the gain of log-likelihood is beyond chance (a paired test on the blocks of time in which the predictions differ,
//!    false discovery rate over all structures that are tried), it lowers the error of a joint by
//!    [`Demands::reduction`], and one of its numbers is two deviations from nothing, or from what is given. Of several the one that lowers the error
//!    of the *fitted* recordings most, for its count of numbers, is added, and the rest is tried again.
//! 3. Every structure of the final model is taken out and the rest estimated again. It is *needed* if the held-out recordings
//!    are then predicted worse, by the same test; else it is *not supported*, with the demand that it does not meet.
//!
//! Another structure that would have been added and predicts as well as the one that was is named as its alternative.

mod evidence;
mod foresight;
mod structures;

pub use evidence::{Comparison, FEWEST_BLOCKS, Missed, compare};
pub(crate) use foresight::{BlockApart, Foresight};
pub use structures::{STRUCTURES, Structure, deciders};

use aurt_calibration::drives::{
    DriveError, DriveRecording, DrivenArm, EstimatedNumber, Options, OutputErrorFit, Selection,
    output_error_from,
};

use self::evidence::largest_of_claims;

/// What a structure must bring.
#[derive(Debug, Clone, PartialEq)]
pub struct Demands {
    /// False discovery rate.
    pub level: f64,
    /// Least share by which it lowers the held-out error of some joint.
    pub reduction: f64,
    /// Names of structures that are not examined.
    pub without: Vec<String>,
}

impl Default for Demands {
    fn default() -> Self {
        Self { level: 0.05, reduction: 0.05, without: Vec::new() }
    }
}

/// What is said of a structure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Answer {
    /// The model has it, and without it predicts worse.
    Needed,
    /// The model lacks it, and with it predicts better.
    Missing,
    /// The model has it with given numbers, and with others predicts better.
    Wrong,
    /// The recordings do not show it: why stands in [`Finding::objection`].
    NotSupported,
}

/// The demand that a structure does not meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Objection {
    /// Chance alone predicts so much better.
    Chance,
    /// It lowers the error of no joint by [`Demands::reduction`].
    Reduction,
    /// None of its numbers is two deviations from nothing, or from what is given.
    Size,
    /// It does not lower the cost of the fitted recordings by what chance does.
    Fit,
}

/// A structure that was examined.
#[derive(Debug, Clone)]
pub struct Finding {
    pub structure: Structure,
    /// What is said of it.
    pub answer: Answer,
    /// Why it is not supported.
    pub objection: Option<Objection>,
    /// Whether the model in question has it.
    pub is_in_model: bool,
    /// Its numbers in the model that has it; none of a structure that was given.
    pub numbers: Vec<EstimatedNumber>,
    /// The model with it against the model without.
    pub comparison: Comparison,
    /// Structures that explain the same as well.
    pub alternatives: Vec<&'static str>,
}

/// The result of [`diagnose`].
#[derive(Debug, Clone)]
pub struct Diagnosis {
    /// The model in question.
    pub described: OutputErrorFit,
    /// What it misses of the held-out recordings.
    pub missed: Missed,
    /// The model with what is missing; that in question if nothing is.
    pub improved: OutputErrorFit,
    /// What it misses of the held-out recordings.
    pub missed_improved: Missed,
    /// What is estimated of it.
    pub selection: Selection,
    /// Every structure that was examined: needed and missing ones first, the largest gain first.
    pub findings: Vec<Finding>,
    /// The improved model, its deviations without what numbers that are given may be off.
    pub(crate) model: JudgedFit,
    pub(crate) contested: Vec<ContestedStructure>,
    /// Those that [`diagnose`] was given, and what was asked of structures.
    pub(crate) options: Options,
    pub(crate) demands: Demands,
}

/// A model that was fitted and judged.
#[derive(Debug, Clone)]
pub(crate) struct JudgedFit {
    pub(crate) arm: DrivenArm,
    pub(crate) selection: Selection,
    pub(crate) fit: OutputErrorFit,
    pub(crate) missed: Missed,
}

/// A structure that is not supported although predictions are better with it on average.
#[derive(Debug, Clone)]
pub(crate) struct ContestedStructure {
    pub(crate) structure: Structure,
    pub(crate) objection: Objection,
    /// The improved model with it, or without it where it has it.
    pub(crate) rival: JudgedFit,
    /// True if the improved model lacks it.
    pub(crate) is_absent: bool,
    /// Probability of chance up to which it would be supported: its part of the false discovery rate.
    pub(crate) level: f64,
}

/// Structures that were added to a model, and those that were not.
struct Additions {
    model: JudgedFit,
    /// Structures with their alternatives.
    added: Vec<(Structure, Vec<&'static str>)>,
    findings: Vec<Finding>,
    contested: Vec<ContestedStructure>,
}

pub(crate) struct Search<'a> {
    pub(crate) fitted: &'a [DriveRecording],
    pub(crate) held_out: &'a [DriveRecording],
    pub(crate) options: &'a Options,
    pub(crate) demands: &'a Demands,
}

/// Blocks of little held-out time are shorter, down to this share of [`Options::block_s`]: the variance of a mean knows that
/// neighbours depend on each other.
const SHORTEST_BLOCK: f64 = 0.25;
/// Steps after which a structure that is added is given up unless it lowers the cost by what chance does.
const FIRST_STEPS: usize = 4;
/// A step that lowers the cost by less than this part ends a search from numbers that were found before.
const AGAIN: f64 = 1e-3;

/// Diagnoses a model: `fitted` recordings are estimated from, `held_out` ones decide; `progress` hears what is being tried.
///
/// # Errors
/// As [`output_error`](aurt_calibration::drives::output_error) of the model in question, and [`DriveError::TooShort`].
pub fn diagnose(
    arm: &DrivenArm,
    selection: &Selection,
    [fitted, held_out]: [&[DriveRecording]; 2],
    options: &Options,
    demands: &Demands,
    mut progress: impl FnMut(&str),
) -> Result<Diagnosis, DriveError> {
    let given = options;
    let (lasts_s, shortest_s) = (seconds(held_out), SHORTEST_BLOCK * options.block_s);
    if lasts_s < FEWEST_BLOCKS as f64 * shortest_s {
        return Err(DriveError::TooShort { needed_s: FEWEST_BLOCKS as f64 * shortest_s });
    }
    let options = &Options { block_s: block_s(lasts_s, held_out.len(), options), ..options.clone() };
    let search = Search { fitted, held_out, options, demands };
    progress("the model as it is described");
    let described = search.trial(arm.clone(), selection.clone(), arm, options)?;
    let again = Options { tolerance: AGAIN, ..options.clone() };
    let options = &again;
    let search = Search { options, ..search };
    let blocks = compare(&described.missed, &described.missed, options).blocks;
    if blocks < FEWEST_BLOCKS {
        return Err(DriveError::TooShort { needed_s: FEWEST_BLOCKS as f64 * options.block_s });
    }
    let examined: Vec<Structure> =
        STRUCTURES.into_iter().filter(|s| s.fits(arm) && demands.without.iter().all(|w| w != s.id)).collect();
    let Additions { mut model, added, mut findings, mut contested } =
        search.additions(&described, &examined, &mut progress);
    let narrow = model.clone();
    model.fit.widen(&model.selection, fitted, options)?;
    let mut taken = Vec::new();
    let is_taken = |s: &&Structure| {
        let is_there = s.is_in(&model.fit.arm) || s.is_selected(&model.selection);
        is_there && (s.is_optional() || added.iter().any(|a| a.0 == **s))
    };
    for structure in examined.iter().filter(is_taken) {
        progress(&format!("without {}", structure.title));
        let (comparison, trial) = match search.without(structure, &model) {
            Ok(trial) => (compare(&model.missed, &trial.missed, options), Some(trial)),
            Err(DriveError::Diverged { .. }) => (Comparison::against_divergence(&model.missed, blocks), None),
            Err(error) => return Err(error),
        };
        taken.push((*structure, comparison, trial));
    }
    let probabilities: Vec<f64> = taken.iter().map(|t| t.1.probability).collect();
    let largest = largest_of_claims(&probabilities, demands.level);
    let claims = probabilities.iter().filter(|p| **p <= largest).count();
    let level = (demands.level * (claims + 1) as f64 / probabilities.len().max(1) as f64).min(demands.level);
    for (structure, comparison, trial) in taken {
        let addition = added.iter().find(|a| a.0 == structure);
        let is_given = addition.is_some() && structure.is_in(arm);
        // A scale that is free makes every number of what is there uncertain, and nothing the less needed.
        let own = addition.map(|_| (&structure, is_given, &model.fit));
        let objection = search.objection(own, &comparison, largest);
        let answer = match addition {
            _ if objection.is_some() => Answer::NotSupported,
            Some(_) if is_given => Answer::Wrong,
            Some(_) => Answer::Missing,
            None => Answer::Needed,
        };
        if let (Some(objection), Some(rival), true) = (objection, trial, comparison.gain_per_s > 0.0) {
            contested.push(ContestedStructure { structure, objection, rival, is_absent: false, level });
        }
        let mut found = finding(structure, answer, is_given || addition.is_none(), &model.fit, comparison);
        found.objection = objection;
        found.alternatives = addition.map_or_else(Vec::new, |a| a.1.clone());
        findings.push(found);
    }
    findings.sort_by(|a, b| {
        let rank = |f: &Finding| f.answer == Answer::NotSupported;
        rank(a).cmp(&rank(b)).then(b.comparison.gain_per_s.total_cmp(&a.comparison.gain_per_s))
    });
    Ok(Diagnosis {
        described: described.fit,
        missed: described.missed,
        improved: model.fit,
        missed_improved: model.missed,
        selection: model.selection,
        findings,
        model: narrow,
        contested,
        options: given.clone(),
        demands: demands.clone(),
    })
}

pub(crate) fn seconds(recordings: &[DriveRecording]) -> f64 {
    recordings.iter().map(|r| r.time_s[r.time_s.len() - 1] - r.time_s[r.first]).sum()
}

/// The length of the blocks of so many held-out recordings that last so long together; a block of each is a part of one.
pub(crate) fn block_s(lasts_s: f64, recordings: usize, options: &Options) -> f64 {
    let shortest_s = SHORTEST_BLOCK * options.block_s;
    (lasts_s / (FEWEST_BLOCKS + recordings) as f64).clamp(shortest_s, options.block_s)
}

/// The cost of the fitted recordings with what numbers lower it by, as [`lowers`] asks for.
fn worth(trial: &JudgedFit) -> f64 {
    trial.fit.cost + 2.0 * trial.fit.numbers.len() as f64
}

fn misfit(trial: &JudgedFit, model: &JudgedFit) -> Option<Objection> {
    (!lowers(trial, model)).then_some(Objection::Fit)
}

/// Whether the cost of the fitted recordings is lower than that of `model` by two for each number that was added: by chance
/// alone it is lower by one.
fn lowers(trial: &JudgedFit, model: &JudgedFit) -> bool {
    let more = trial.fit.numbers.len() - model.fit.numbers.len();
    model.fit.cost - trial.fit.cost >= 2.0 * more as f64
}

fn finding(
    structure: Structure,
    answer: Answer,
    is_in_model: bool,
    fit: &OutputErrorFit,
    comparison: Comparison,
) -> Finding {
    let numbers = fit.numbers.iter().filter(|n| structure.has(&n.name)).cloned().collect();
    let alternatives = Vec::new();
    Finding { structure, answer, objection: None, is_in_model, numbers, comparison, alternatives }
}

impl Search<'_> {
    /// The model with what it lacks: structures are added as long as one brings what is demanded.
    fn additions(
        &self,
        described: &JudgedFit,
        examined: &[Structure],
        progress: &mut impl FnMut(&str),
    ) -> Additions {
        let mut absent: Vec<Structure> =
            examined.iter().copied().filter(|s| !s.is_selected(&described.selection)).collect();
        let mut model = described.clone();
        let mut added: Vec<(Structure, Vec<&'static str>)> = Vec::new();
        loop {
            let mut tried = Vec::new();
            for structure in &absent {
                progress(&format!("with {}", structure.title));
                if let Some(trial) = self.with(structure, &model) {
                    let comparison = compare(&trial.missed, &model.missed, self.options);
                    tried.push((*structure, trial, comparison));
                }
            }
            // Structures without a fit were tried as well.
            let mut probabilities: Vec<f64> = tried.iter().map(|t| t.2.probability).collect();
            probabilities.resize(absent.len(), 1.0);
            let largest = largest_of_claims(&probabilities, self.demands.level);
            let objection = |(s, trial, c): &(Structure, JudgedFit, Comparison)| {
                self.objection(Some((s, s.is_in(&described.arm), &trial.fit)), c, largest)
                    .or_else(|| misfit(trial, &model))
            };
            let passes = |k: &usize| objection(&tried[*k]).is_none();
            let best = (0..tried.len())
                .filter(passes)
                .min_by(|a, b| worth(&tried[*a].1).total_cmp(&worth(&tried[*b].1)));
            let Some(best) = best else {
                let level = self.demands.level / absent.len().max(1) as f64;
                let refused = |t: &(Structure, JudgedFit, Comparison)| {
                    let found = finding(t.0, Answer::NotSupported, false, &t.1.fit, t.2.clone());
                    Finding { objection: objection(t), ..found }
                };
                let contested = tried.iter().filter(|t| t.2.gain_per_s > 0.0 && lowers(&t.1, &model));
                let contested = contested.filter_map(|t| {
                    let (structure, rival, objection) = (t.0, t.1.clone(), objection(t)?);
                    Some(ContestedStructure { structure, objection, rival, is_absent: true, level })
                });
                let contested = contested.collect();
                let findings = tried.iter().filter(|(s, ..)| !s.is_in(&described.arm)).map(refused).collect();
                return Additions { model, added, findings, contested };
            };
            let rivals = (0..tried.len()).filter(|k| *k != best && passes(k));
            let equal = |k: &usize| {
                compare(&tried[best].1.missed, &tried[*k].1.missed, self.options).probability
                    > self.demands.level
            };
            let alternatives: Vec<&'static str> = rivals.filter(equal).map(|k| tried[k].0.id).collect();
            let (structure, trial, _) = tried.swap_remove(best);
            absent.retain(|s| *s != structure);
            added.push((structure, alternatives));
            model = trial;
        }
    }

    fn trial(
        &self,
        arm: DrivenArm,
        selection: Selection,
        from: &DrivenArm,
        options: &Options,
    ) -> Result<JudgedFit, DriveError> {
        let fit = output_error_from(&arm, &selection, self.fitted, options, from)?;
        let missed = Missed::of(&fit.arm, self.held_out, options)?;
        Ok(JudgedFit { arm, selection, fit, missed })
    }

    /// The model with a structure taken out.
    pub(crate) fn without(&self, structure: &Structure, model: &JudgedFit) -> Result<JudgedFit, DriveError> {
        let [arm, from] = [&model.arm, &model.fit.arm].map(|a| {
            let mut a = a.clone();
            structure.remove(&mut a);
            a
        });
        self.trial(arm, structure.unselect(&model.selection), &from, self.options)
    }

    /// The model with a structure, estimated to the end if the first steps lower the cost of the fitted recordings by more than
    /// chance does; none if it cannot be simulated.
    pub(crate) fn with(&self, structure: &Structure, model: &JudgedFit) -> Option<JudgedFit> {
        let [arm, from] = [&model.arm, &model.fit.arm].map(|a| {
            let mut arm = a.clone();
            if !structure.is_in(a) {
                structure.add(&mut arm, self.fitted);
            }
            arm
        });
        let selection = structure.select(&arm, &model.selection);
        let first = Options { most_iterations: FIRST_STEPS, ..self.options.clone() };
        let begun = self.trial(arm.clone(), selection.clone(), &from, &first).ok()?;
        if lowers(&begun, model) {
            return self.trial(arm, selection, &begun.fit.arm, self.options).ok();
        }
        Some(begun)
    }

    /// The first demand that a structure does not meet; of one that was added, with the fit that has its numbers, their size too.
    fn objection(
        &self,
        added: Option<(&Structure, bool, &OutputErrorFit)>,
        comparison: &Comparison,
        largest: f64,
    ) -> Option<Objection> {
        let is_small = |(structure, is_given, fit): (&Structure, bool, &OutputErrorFit)| {
            let mut own = fit.numbers.iter().filter(|n| structure.has(&n.name)).peekable();
            own.peek().is_some() && !own.any(|n| is_beyond(structure, n, is_given))
        };
        if comparison.probability > largest {
            Some(Objection::Chance)
        } else if comparison.reduction < self.demands.reduction {
            Some(Objection::Reduction)
        } else {
            added.filter(|a| is_small(*a)).map(|_| Objection::Size)
        }
    }
}

/// Whether a number is two deviations from the value at which it does nothing, or from what is given.
pub fn is_beyond(structure: &Structure, number: &EstimatedNumber, is_given: bool) -> bool {
    let from = if is_given { Some(number.start) } else { structure.neutral() };
    let far = |from: f64| (number.value - from).abs() > (2.0 * number.deviation).max(1e-6);
    from.is_none_or(far)
}
