//! The search: one mistake at a time, in pairs where none helps alone, and again until nothing more is gained.

use rayon::prelude::*;

use super::evidence::{Evidence, TESTS};
use super::explained::LEAST_EXPLAINED;
use super::folds::{folds, likelier, within};
use super::found::{Compared, Found, Step};
use super::mistake::{Mistake, Reading};
use super::setup::{Setup, Subject};
use super::trial::{Bench, Score, WORST};
use super::usual::{is_likely, of_file, usual};
use super::variations::variations;

/// Of a setup whose error is below this at every joint only the likely mistakes are tried.
const FINE: f64 = 0.2;
/// The same over all joints, where a calibrated model explains each of them.
const DOUBTFUL: f64 = 0.5;
const PAIRED: usize = 4;
/// Pairs are tried where the error is at least this.
const PAIRS_FROM: f64 = 0.4;
/// Of mistakes of which the gain is within this of the best one, the most usual is told.
const ALIKE: f64 = 0.3;
/// Fitted values are told if they take the error to at most this share of that with the values tried.
const ROUND: f64 = 0.85;
/// A fitted value is better by this gain at least.
const LEAST_STEP: f64 = 0.03;
/// Mistakes that are told together at most.
const MOST: usize = 4;

#[derive(Clone)]
pub(super) struct Attempt {
    mistakes: Vec<Mistake>,
    setup: Setup,
    pub(super) score: Score,
    alike: Vec<Mistake>,
}

impl Attempt {
    pub(super) fn last(&self) -> Option<&Mistake> {
        self.mistakes.last()
    }

    /// Whether it is a gain of a joint that another gain of the joint explains alike: the data do not determine it, and what
    /// gets better is the weight that the joint has among the others.
    fn has_no_size(&self) -> bool {
        let of_joint = |m: &Mistake| match m {
            Mistake::Reading { what: Reading::Gain { joint, .. }, file } => Some((*joint, *file)),
            _ => None,
        };
        let own = self.last().and_then(of_joint);
        own.is_some() && self.alike.iter().any(|other| of_joint(other) == own)
    }
}

enum Tested {
    Told,
    /// Stretches of recordings are less likely with it, or it could be any number.
    Refuted,
    Open,
}

pub(super) struct Search<'a> {
    pub(super) subject: &'a Subject,
    pub(super) bench: &'a Bench,
    pub(super) whole: &'a Setup,
    pub(super) found: Found,
}

/// From which error on all mistakes are tried, in pairs too; below it the likely ones are, each alone, or none.
#[derive(Debug, Clone, Copy)]
pub enum Thorough {
    /// If a joint's error is at least 20 %.
    AnyJoint,
    /// If that over all joints is at least 50 %; below, none is tried.
    AllJoints,
    Always,
}

/// Looks for mistakes in a setup; `whole` is the same with all of its recordings.
pub fn search(subject: &Subject, bench: &Bench, [setup, whole]: [&Setup; 2], thorough: Thorough) -> Found {
    let before = bench.score(setup);
    let fine = |s: &Score| {
        let little = match thorough {
            Thorough::AnyJoint => s.of_moving().all(|(_, e)| e < FINE),
            Thorough::AllJoints => s.total < DOUBTFUL,
            Thorough::Always => false,
        };
        little && !s.fed.contains(&true)
    };
    let found = Found { before: before.clone(), after: before.clone(), trials: 1, ..Found::default() };
    let mut search = Search { subject, bench, whole, found };
    let mut steps: Vec<Step> = Vec::new();
    let (mut now, mut score) = (setup.clone(), before);
    while steps.len() < MOST {
        let told: Vec<&Mistake> = steps.iter().map(|s| &s.mistake).collect();
        let is_fine = score.as_ref().is_some_and(fine);
        // A calibrated model that explains its recordings is not doubted: whoever asks has `aurt check`.
        if is_fine && matches!(thorough, Thorough::AllJoints) {
            break;
        }
        let Some(best) = search.round(&now, score.as_ref(), &told, is_fine) else { break };
        let mut setup = now;
        let last = best.mistakes.len() - 1;
        for (k, mistake) in best.mistakes.into_iter().enumerate() {
            setup = mistake.undone(&setup);
            let after = if k == last { None } else { bench.score(&setup) };
            let alike = if k == last { best.alike.clone() } else { Vec::new() };
            let after = after.unwrap_or_else(|| best.score.clone());
            steps.push(Step { alike, ..Step::new(mistake, after) });
        }
        now = setup;
        score = Some(best.score);
    }
    if steps.len() > 1
        && let Some(last) = score.take()
    {
        score = Some(search.reconsidered(setup, &mut steps, last));
    }
    // To compare robots takes seconds, many times as long as a calibration: `run` leaves that to `check`.
    if steps.is_empty()
        && !matches!(thorough, Thorough::AllJoints)
        && let Some(step) = search.in_one(&now).or_else(|| search.likelier(&now))
    {
        score = Some(step.after.clone());
        steps.push(step);
    }
    let found = search.found;
    // What raises the error is no cure, whatever else it explains.
    let least = found.before.as_ref().map_or(f64::INFINITY, |b| b.total);
    match score.filter(|s| is_explained(s.total) && s.total < least) {
        Some(after) => Found { steps, after: Some(after), ..found },
        None => found,
    }
}

impl Search<'_> {
    /// A mistake in one recording, told by how the others predict it.
    ///
    /// A model fitted to all recordings takes up part of what is wrong with one of them, and what is held out may not have it at
    /// all: the recording itself, predicted from the others, shows it whole.
    fn in_one(&mut self, setup: &Setup) -> Option<Step> {
        let bench = self.bench;
        let mut found: Vec<(f64, Mistake)> = Vec::new();
        for (file, fold) in folds(setup) {
            let Some(fit) = bench.fit(&fold) else { continue };
            let Some(before) = bench.judge(&fold, &fit) else { continue };
            let mistakes = of_file(fold.moving_joints(), file);
            let tried = self.tried(&fold, &mistakes, &[], |other| bench.judge(other, &fit));
            let told = self.told(&fold, Some(&before), &tried).filter(|one| is_explained(one.score.total));
            found.extend(told.and_then(|one| {
                let gain = before.logarithm() - one.score.logarithm();
                one.last().map(|m| (gain, m.clone()))
            }));
        }
        let (_, mistake) = found.into_iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
        let after = bench.score(&mistake.undone(setup))?;
        Some(Step::new(mistake, after))
    }

    /// Another robot or gravity, told by how much likelier it makes every recording.
    fn likelier(&mut self, setup: &Setup) -> Option<Step> {
        if !self.subject.compares_robots() {
            return None;
        }
        let now = self.bench.score(setup)?;
        let tried = likelier(self.subject, self.bench, setup, &mut self.found.trials);
        let most = tried.iter().max_by(|a, b| a.evidence.gain.total_cmp(&b.evidence.gain))?;
        let mut near: Vec<Mistake> = Vec::new();
        for one in tried.iter().filter(|one| !one.is_behind(most)) {
            let other = one.mistake.undone(setup);
            // What raises the error with plain friction is no cure.
            let errors = [now.total, self.bench.score(&other).map_or(WORST, |after| after.total)];
            if matches!(self.tested([setup, &other], &one.mistake, one.evidence, errors), Tested::Told) {
                near.push(one.mistake.clone());
            } else if one.mistake == most.mistake {
                return None;
            }
        }
        let mistake = near.first()?.clone();
        let after = self.bench.score(&mistake.undone(setup))?;
        let joints = after.joints.iter().flatten().count().max(1) as f64;
        let likelier = Some((-most.evidence.gain / joints).exp());
        Some(Step { likelier, alike: near.split_off(1), ..Step::new(mistake, after) })
    }

    /// The first of those that are nearly the likeliest, if it is told, with the rest of these. What stretches of recordings refute
    /// is left out; what they neither refute nor confirm leaves nothing to be told.
    pub(super) fn told(&mut self, now: &Setup, before: Option<&Score>, tried: &[Attempt]) -> Option<Attempt> {
        let error = before.map_or(WORST, |b| b.total);
        let enough = |t: &&Attempt| Evidence::of([(before, &t.score)]).filter(Evidence::is_enough);
        let mut open: Vec<(Evidence, &Attempt)> =
            tried.iter().filter(|t| t.score.total < error).filter_map(|t| Some((enough(&t)?, t))).collect();
        loop {
            let most = open.iter().map(|(e, _)| e.gain).max_by(f64::total_cmp)?;
            // Of those that are nearly as good the most usual one.
            let (across, first) = *open.iter().find(|(e, _)| e.gain >= most - ALIKE)?;
            let is_behind = |t: &Attempt| {
                Evidence::of([(Some(&t.score), &first.score)]).is_some_and(|e| e.gain > ALIKE && e.is_sure(1))
            };
            let others = open.iter().filter(|(_, t)| t.mistakes != first.mistakes && !is_behind(t));
            let alike = others.filter_map(|(_, t)| t.last().cloned()).collect();
            let best = Attempt { alike, ..first.clone() };
            let mistake = best.last()?;
            let errors = [error, best.score.total];
            let is_elsewhere = before.is_some_and(|b| !best.score.is_better_on(&mistake.own_joints(), b));
            let tested = self.tested([now, &best.setup], mistake, across, errors);
            match if is_elsewhere { Tested::Open } else { tested } {
                Tested::Told if !best.has_no_size() => return Some(best),
                Tested::Open => return None,
                Tested::Told | Tested::Refuted => {
                    let is_reading = matches!(mistake, Mistake::Reading { .. });
                    let is_out = |t: &Attempt| {
                        t.mistakes == best.mistakes
                            || is_reading && t.last().is_some_and(|m| m.is_about_what(mistake))
                    };
                    open.retain(|(_, t)| !is_out(t));
                }
            }
        }
    }

    /// Whether a setup is told for another one: it makes what is held out likelier by enough, lowers the error, and makes stretches
    /// of recordings likelier too. Neither is by chance, and one of the two not even for the best of all that are tried.
    fn tested(
        &mut self,
        [now, other]: [&Setup; 2],
        mistake: &Mistake,
        across: Evidence,
        errors: [f64; 2],
    ) -> Tested {
        let bench = self.bench_for(mistake);
        let within = (across.is_enough() && errors[1] < errors[0])
            .then(|| within(&bench, self.whole, [now, other], mistake.file()))
            .flatten();
        self.found.compared.push(Compared { mistake: mistake.clone(), across, within, errors });
        let Some(within) = within else { return Tested::Open };
        if within.gain < 0.0 || !self.is_alone(&bench, now, mistake) {
            return Tested::Refuted;
        }
        // That friction comes late is known from within alone.
        let is_confirmed = if mistake.is_delay() { within.is_enough() } else { within.is_sure(1) };
        let tried = TESTS * self.found.trials;
        let is_sure = across.is_sure(tried) || within.is_sure(tried);
        if is_confirmed && is_sure { Tested::Told } else { Tested::Open }
    }

    /// What else than the mistake could explain the data: friction that builds up over a distance comes late, and friction that
    /// grows with the load makes up for bodies that are elsewhere or columns in another order.
    fn bench_for(&self, mistake: &Mistake) -> Bench {
        match mistake {
            Mistake::Gravity { .. }
            | Mistake::Geometry { .. }
            | Mistake::Reading { what: Reading::Order { .. }, .. } => self.bench.comparing(),
            Mistake::Reading { what: Reading::Delay(_), .. } => self.bench.presliding(),
            Mistake::Reading { .. } => self.bench.clone(),
        }
    }

    /// Whether a mistake of one recording is none of the others: undone in these too, it would make each of them less likely. What
    /// friction does in all of them, like a delay, is none of one.
    fn is_alone(&self, bench: &Bench, now: &Setup, mistake: &Mistake) -> bool {
        let Mistake::Reading { what, file: Some(own) } = mistake else { return true };
        // Another recording has no such stretch.
        if matches!(what, Reading::During { .. }) {
            return true;
        }
        let others = now.files().into_iter().filter(|file| file != own).map(|file| {
            let as_well = Mistake::Reading { what: what.clone(), file: Some(file) };
            within(bench, self.whole, [now, &as_well.undone(now)], Some(file))
        });
        others.flatten().all(|evidence| evidence.gain < 0.0)
    }

    /// One more mistake, or two, that are told: of the whole setup, of one recording, in pairs. Of a fine setup the likely ones of
    /// the whole alone.
    fn round(
        &mut self,
        setup: &Setup,
        now: Option<&Score>,
        told: &[&Mistake],
        is_fine: bool,
    ) -> Option<Attempt> {
        let open = |m: &Mistake| !told.iter().any(|t| t.is_about_what(m));
        let mistakes = usual(self.subject, setup).into_iter().filter(open);
        let (likely, others): (Vec<Mistake>, Vec<Mistake>) = mistakes.partition(is_likely);
        let mut singles = self.all(setup, &likely, &[]);
        // What would be told of a fine setup is compared with all the others too.
        if is_fine && self.told(setup, now, &singles).is_none() {
            return None;
        }
        singles.extend(self.all(setup, &others, &[]));
        singles.extend(self.reordered(setup, &singles));
        if let Some(best) = self.told(setup, now, &singles) {
            return Some(self.refined(setup, best));
        }
        let files = setup.files();
        if files.len() > 1 && !is_fine {
            let joints = setup.moving_joints();
            let of_files: Vec<Mistake> =
                files.iter().flat_map(|f| of_file(joints, *f)).filter(open).collect();
            let tried = self.all(setup, &of_files, &[]);
            if let Some(best) = self.told(setup, now, &tried) {
                return Some(self.refined(setup, best));
            }
        }
        if is_fine || now.is_some_and(|s| s.total < PAIRS_FROM) {
            return None;
        }
        singles.sort_by(|a, b| a.score.logarithm().total_cmp(&b.score.logarithm()));
        singles.truncate(PAIRED);
        for one in &singles {
            let second = |m: &&Mistake| !one.mistakes[0].is_about_what(m);
            let second: Vec<Mistake> = likely.iter().filter(second).cloned().collect();
            let pairs = self.all(&one.setup, &second, &one.mistakes);
            // Each of the two is needed.
            if let Some(pair) = self.told(&one.setup, Some(&one.score), &pairs)
                && let Some(pair) = self.told(setup, now, &[pair])
            {
                return Some(self.refined(setup, pair));
            }
        }
        None
    }

    /// Weighs each of several steps once more against the other mistakes about the same thing, now that all the others are
    /// undone: what was the best guess beside a turned sign need not be without it. Of those that explain the data alike the
    /// likeliest is told. Returns the error in the end.
    fn reconsidered(&mut self, setup: &Setup, steps: &mut [Step], mut score: Score) -> Score {
        for at in 0..steps.len() {
            let own = steps[at].mistake.clone();
            if matches!(own, Mistake::Reading { file: Some(_), .. }) {
                continue;
            }
            let others = steps.iter().enumerate().filter(|(k, _)| *k != at);
            let without = others.fold(setup.clone(), |s, (_, step)| step.mistake.undone(&s));
            let mut rivals: Vec<Mistake> =
                usual(self.subject, &without).into_iter().filter(|m| m.is_about_what(&own)).collect();
            if rivals.iter().all(|m| *m == own) {
                continue;
            }
            if !rivals.contains(&own) {
                rivals.push(own.clone());
            }
            let tried = self.all(&without, &rivals, &[]);
            let Some(best) = self.likeliest(&tried) else { continue };
            if let Some(mistake) = best.mistakes.into_iter().next().filter(|m| *m != own) {
                steps[at].mistake = mistake;
                steps[at].alike = best.alike;
                score = best.score;
            }
        }
        let mut now = setup.clone();
        for step in steps {
            now = step.mistake.undone(&now);
            step.after = self.bench.score(&now).unwrap_or_else(|| score.clone());
        }
        score
    }

    /// The likeliest order of columns after further exchanges of two, each the best of all: any order is a product of them.
    fn reordered(&mut self, setup: &Setup, tried: &[Attempt]) -> Option<Attempt> {
        let least = |a: &&Attempt, b: &&Attempt| a.score.logarithm().total_cmp(&b.score.logarithm());
        let orders = tried
            .iter()
            .filter(|t| matches!(t.last(), Some(Mistake::Reading { what: Reading::Order { .. }, .. })));
        let first = orders.min_by(least)?;
        let mut best = first.clone();
        loop {
            let exchanged = best.last().map(Mistake::exchanges).unwrap_or_default();
            let next = self.all(setup, &exchanged, &[]);
            match next.iter().min_by(least) {
                Some(next) if next.score.logarithm() < best.score.logarithm() - LEAST_STEP => {
                    best = next.clone()
                }
                _ => break,
            }
        }
        (best.mistakes != first.mistakes).then_some(best)
    }

    fn all(&mut self, setup: &Setup, mistakes: &[Mistake], before: &[Mistake]) -> Vec<Attempt> {
        let bench = self.bench;
        self.tried(setup, mistakes, before, |other| bench.score(other))
    }

    pub(super) fn tried(
        &mut self,
        setup: &Setup,
        mistakes: &[Mistake],
        before: &[Mistake],
        score: impl Fn(&Setup) -> Option<Score> + Sync,
    ) -> Vec<Attempt> {
        self.found.trials += mistakes.len();
        // What does not change is prepared once.
        setup.parts.iter().for_each(|p| drop(p.prepared()));
        mistakes
            .par_iter()
            .filter_map(|mistake| {
                let setup = mistake.undone(setup);
                let score = score(&setup)?;
                let mistakes = before.iter().chain([mistake]).cloned().collect();
                Some(Attempt { mistakes, setup, score, alike: Vec::new() })
            })
            .collect()
    }

    /// The first of those that are nearly the likeliest, with the rest of these.
    fn likeliest(&self, tried: &[Attempt]) -> Option<Attempt> {
        let least = tried.iter().map(|t| t.score.logarithm()).min_by(f64::total_cmp)?;
        let mut near = tried.iter().filter(|t| t.score.logarithm() <= least + ALIKE);
        let first = near.next()?;
        Some(Attempt { alike: near.filter_map(|t| t.last().cloned()).collect(), ..first.clone() })
    }

    /// The same with numbers that were tried coarsely fitted.
    fn refined(&mut self, setup: &Setup, tried: Attempt) -> Attempt {
        let coarse = tried.clone();
        let mut best = tried;
        for at in 0..best.mistakes.len() {
            let mut step = 1.0;
            for _ in 0..8 {
                let around = variations(&best.mistakes[at], step);
                step *= 0.6;
                let better = around.into_iter().filter_map(|changed| {
                    self.found.trials += 1;
                    let mut mistakes = best.mistakes.clone();
                    mistakes[at] = changed;
                    let setup = mistakes.iter().fold(setup.clone(), |s, m| m.undone(&s));
                    let score = self.bench.score(&setup)?;
                    Some(Attempt { mistakes, setup, score, alike: best.alike.clone() })
                });
                let better = better.min_by(|a, b| a.score.logarithm().total_cmp(&b.score.logarithm()));
                if let Some(better) =
                    better.filter(|b| b.score.logarithm() < best.score.logarithm() - LEAST_STEP)
                {
                    best = better;
                }
            }
        }
        // Round values are meant where fitted ones are hardly better.
        if best.score.total > ROUND * coarse.score.total { coarse } else { best }
    }
}

/// What was found must explain the data: with a larger error it is a setup that is wrong in another way.
pub(super) fn is_explained(error: f64) -> bool {
    1.0 - error * error >= LEAST_EXPLAINED
}
