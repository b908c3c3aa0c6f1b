//! Every recording in turn predicted from the others: what tells mistakes that a fit to all of them takes up.

use std::sync::OnceLock;

use rayon::prelude::*;

use super::{
    mistake::{Mistake, Table},
    setup::{Setup, Subject},
    trial::{Bench, Score},
    usual::{of_file, usual},
};

/// Setups in which one recording judges and all others are fitted; none of a single recording.
fn folds(setup: &Setup) -> Vec<(usize, Setup)> {
    let files = setup.files();
    if files.len() < 2 {
        return Vec::new();
    }
    // What does not change is prepared once.
    setup.parts.iter().for_each(|p| drop(p.prepared()));
    let fold = |file: &usize| {
        let mut fold = setup.clone();
        fold.parts.iter_mut().for_each(|part| part.fitted = part.file != *file);
        (*file, fold)
    };
    files.iter().map(fold).collect()
}

/// A mistake in one recording, with the error of that recording before and after.
pub struct InOne {
    pub mistake: Mistake,
    pub before: f64,
    pub after: f64,
}

/// The mistake in one recording that takes the error with which the others predict it to the smallest share.
///
/// A model fitted to all recordings takes up part of what is wrong with one of them, and what is held out may not have it at
/// all: the recording itself, predicted from the others, shows it whole.
pub fn in_one(bench: &Bench, setup: &Setup, trials: &mut usize) -> Option<InOne> {
    let tried: Vec<Vec<InOne>> = folds(setup)
        .into_iter()
        .map(|(file, fold)| {
            let mistakes = of_file(fold.moving_joints(), file);
            *trials += mistakes.len() + 1;
            let Some(before) = bench.score(&fold).map(|s| s.total) else { return Vec::new() };
            mistakes
                .into_par_iter()
                .filter_map(|mistake| {
                    let after = bench.score(&mistake.undone(&fold))?.total;
                    Some(InOne { mistake, before, after })
                })
                .collect()
        })
        .collect();
    let share = |one: &InOne| one.after / one.before.min(1.0);
    tried.into_iter().flatten().min_by(|a, b| share(a).total_cmp(&share(b)))
}

/// How another robot predicts each recording from the others, against the one that was set up.
pub struct Likelier {
    pub mistake: Mistake,
    /// The factor of the error, geometric mean over joints and recordings.
    pub factor: f64,
}

/// Robots and gravities without a free number, the more usual mistakes first.
///
/// With a deviation σ_j of its own for each joint the likelihood of a recording is Π_j σ_j^(−n_j): the mean of ln σ_j over joints
/// compares setups that have as many numbers to fit. A joint of little noise counts as much as one of much. What holds a
/// joint at rest knows no sign, and friction that grows with the load is larger than what a wrong length leaves: without the
/// rows at rest, and with that friction, a zero that is a quarter turn off stands out.
///
/// What does not take the error of every recording to `each` is left where the first says so.
pub fn likelier(
    subject: &Subject,
    bench: &Bench,
    setup: &Setup,
    each: f64,
    trials: &mut usize,
) -> Vec<Likelier> {
    // The model of the other trials has other friction.
    let bench = &Bench { compares: true, ..bench.clone() };
    let setup = &Setup { model: OnceLock::new(), ..setup.clone() };
    let now: Option<Vec<Score>> = folds(setup).iter().map(|(_, fold)| bench.score(fold)).collect();
    let Some(now) = now.filter(|n| !n.is_empty()) else { return Vec::new() };
    let mistakes: Vec<Mistake> = usual(subject, setup).into_iter().filter(is_of_the_robot).collect();
    *trials += now.len() * (mistakes.len() + 1);
    mistakes
        .into_par_iter()
        .filter_map(|mistake| {
            let other = mistake.undone(setup);
            let gains: Option<Vec<f64>> = folds(&other)
                .iter()
                .zip(&now)
                .map(|((_, fold), before)| {
                    let gain = gain(before, &bench.score(fold)?);
                    (gain < each.ln()).then_some(gain)
                })
                .collect();
            let gains = gains?;
            let mean = gains.iter().sum::<f64>() / gains.len() as f64;
            Some(Likelier { mistake, factor: mean.exp() })
        })
        .collect()
}

fn is_of_the_robot(mistake: &Mistake) -> bool {
    match mistake {
        Mistake::Gravity { to_m_s2 } => to_m_s2.iter().filter(|v| **v != 0.0).count() == 1,
        Mistake::Geometry { what, .. } => !matches!(what, Table::Lengths(_)),
        Mistake::Reading { .. } => false,
    }
}

/// The mean over joints of ln(σ after / σ before).
fn gain(before: &Score, after: &Score) -> f64 {
    let both = before.joints.iter().zip(&after.joints);
    let ratios: Vec<f64> = both.filter_map(|(b, a)| b.zip(*a)).map(|(b, a)| (a / b).ln()).collect();
    ratios.iter().sum::<f64>() / ratios.len().max(1) as f64
}
