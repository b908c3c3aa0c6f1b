//! Every recording in turn predicted from the others: what tells mistakes that a fit to all of them takes up.

use rayon::prelude::*;

use super::evidence::Evidence;
use super::mistake::{Mistake, Table};
use super::setup::{Setup, Subject};
use super::trial::{Bench, Score};
use super::usual::usual;

/// Setups in which one recording judges and all others are fitted; none of a single recording.
pub fn folds(setup: &Setup) -> Vec<(usize, Setup)> {
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

/// How much likelier another setup makes stretches of recordings, each predicted from the rest of its own recording.
///
/// What changed between recordings, a load for one, is the same in both setups here. `whole` is the setup in which nothing is
/// undone, with all of its recordings.
pub fn within(bench: &Bench, whole: &Setup, setups: [&Setup; 2], file: Option<usize>) -> Option<Evidence> {
    let files = file.map_or_else(|| whole.files(), |f| vec![f]);
    let whole_of = |s: &Setup| s.undone.iter().fold(whole.clone(), |whole, mistake| mistake.undone(&whole));
    let [setup, other] = setups.map(|s| bench.modelled(&whole_of(s)));
    let pairs: Vec<(Setup, Setup)> =
        files.iter().flat_map(|f| setup.stretches(*f).into_iter().zip(other.stretches(*f))).collect();
    let scores: Vec<(Option<Score>, Score)> = pairs
        .into_par_iter()
        .filter_map(|(before, after)| Some((bench.score(&before), bench.score(&after)?)))
        .collect();
    Evidence::of(scores.iter().map(|(before, after)| (before.as_ref(), after)))
}

/// How another robot predicts each recording from the others, against the one that was set up.
pub struct Likelier {
    pub mistake: Mistake,
    pub evidence: Evidence,
    scores: Vec<Score>,
}

impl Likelier {
    /// Whether another one is surely better.
    pub fn is_behind(&self, other: &Self) -> bool {
        Evidence::of(self.scores.iter().map(Some).zip(&other.scores)).is_some_and(|e| e.is_sure(1))
    }
}

/// Robots and gravities without a free number, the more usual mistakes first.
///
/// With a deviation σ_j of its own for each joint the likelihood of a recording is Π_j σ_j^(−n_j): the mean of ln σ_j over joints
/// compares setups that have as many numbers to fit. A joint of little noise counts as much as one of much. What holds a
/// joint at rest knows no sign, and friction that grows with the load is larger than what a wrong length leaves: without the
/// rows at rest, and with that friction, a zero that is a quarter turn off stands out.
///
/// What some recording is less likely with is left out.
pub fn likelier(subject: &Subject, bench: &Bench, setup: &Setup, trials: &mut usize) -> Vec<Likelier> {
    let bench = &bench.comparing();
    let setup = &bench.modelled(setup);
    let now: Option<Vec<Score>> = folds(setup).iter().map(|(_, fold)| bench.score(fold)).collect();
    let Some(now) = now.filter(|n| !n.is_empty()) else { return Vec::new() };
    let mistakes: Vec<Mistake> = usual(subject, setup).into_iter().filter(is_of_the_robot).collect();
    *trials += now.len() * (mistakes.len() + 1);
    mistakes
        .into_par_iter()
        .filter_map(|mistake| {
            let other = mistake.undone(setup);
            let after: Option<Vec<Score>> = folds(&other)
                .iter()
                .zip(&now)
                .map(|((_, fold), before)| {
                    bench
                        .score(fold)
                        .filter(|s| Evidence::of([(Some(before), s)]).is_some_and(|e| e.gain > 0.0))
                })
                .collect();
            let scores = after?;
            let evidence = Evidence::of(now.iter().map(Some).zip(&scores))?;
            Some(Likelier { mistake, evidence, scores })
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
