//! The search: one mistake at a time, in pairs where none helps alone, and again until nothing more is gained.

use rayon::prelude::*;

use super::{
    evidence::{Evidence, LEAST_GAIN, TESTS},
    explained::LEAST_EXPLAINED,
    folds::{in_one, likelier, within},
    mistake::{Mistake, Reading},
    setup::{Setup, Subject},
    trial::{Bench, Score, WORST},
    usual::{is_likely, of_file, usual},
};

/// Of a setup whose error is below this at every joint only the likely mistakes are tried.
const FINE: f64 = 0.3;
/// The same over all joints, where a calibrated model explains each of them.
const DOUBTFUL: f64 = 0.5;
/// Of mistakes that take the error to within this factor of the least one, the likeliest is told.
const ALIKE: f64 = 1.07;
/// Fitted values are told if they take the error to at most this share of that with the values tried.
const ROUND: f64 = 0.85;
/// First mistakes of pairs.
const PAIRED: usize = 4;
/// Pairs are tried where the error is at least this.
const PAIRS_FROM: f64 = 0.4;
/// Mistakes that are told together at most.
const MOST: usize = 4;

/// What the search came to.
#[derive(Debug, Clone)]
pub struct Found {
    /// How well the setup as it is explains the data; nothing if it allows no fit.
    pub before: Option<Score>,
    /// What to undo, in the order of finding, each with the error after it.
    pub steps: Vec<Step>,
    /// How well the setup does without the mistakes.
    pub after: Option<Score>,
    /// Fits that were tried.
    pub trials: usize,
    /// What was compared with the setup that is there or that was found.
    pub compared: Vec<Compared>,
}

/// A setup that was compared with the one that is there, or with that without the mistakes found before.
#[derive(Debug, Clone)]
pub struct Compared {
    /// What is undone in it, the last.
    pub mistake: Mistake,
    /// How much likelier it makes what is held out.
    pub across: Evidence,
    /// How much likelier it makes stretches of recordings, predicted from the rest of their own; where it matters.
    pub within: Option<Evidence>,
    /// The error before and after.
    pub errors: [f64; 2],
}

/// A mistake that was found.
#[derive(Debug, Clone)]
pub struct Step {
    /// Of another robot that is likelier: the factor of the error with which recordings are predicted from each other.
    pub likelier: Option<f64>,
    /// The mistake.
    pub mistake: Mistake,
    /// The error once it is undone too.
    pub after: Score,
    /// Others that explain the data alike.
    pub alike: Vec<Mistake>,
}

struct Tried {
    mistakes: Vec<Mistake>,
    setup: Setup,
    score: Score,
    alike: Vec<Mistake>,
}

impl Tried {
    /// Whether it is a gain of a joint that another gain of the joint explains alike: the data do not determine it, and what
    /// gets better is the weight that the joint has among the others.
    fn has_no_size(&self) -> bool {
        let of_joint = |m: &Mistake| match m {
            Mistake::Reading { what: Reading::Gain { joint, .. }, file } => Some((*joint, *file)),
            _ => None,
        };
        let own = self.mistakes.last().and_then(of_joint);
        own.is_some() && self.alike.iter().any(|other| of_joint(other) == own)
    }
}

struct Search<'a> {
    subject: &'a Subject,
    bench: &'a Bench,
    trials: usize,
    compared: Vec<Compared>,
}

/// From which error on all mistakes are tried, in pairs too; below it the likely ones are, each alone, or none.
#[derive(Debug, Clone, Copy)]
pub enum Thorough {
    /// If a joint's error is at least 30 %.
    AnyJoint,
    /// If that over all joints is at least 50 %; below, none is tried.
    AllJoints,
    /// In any case.
    Always,
}

/// Looks for mistakes.
pub fn search(subject: &Subject, bench: &Bench, setup: &Setup, thorough: Thorough) -> Found {
    let before = bench.score(setup);
    let fine = |s: &Score| {
        let little = match thorough {
            Thorough::AnyJoint => s.of_moving().all(|(_, e)| e < FINE),
            Thorough::AllJoints => s.total < DOUBTFUL,
            Thorough::Always => false,
        };
        little && !s.fed.contains(&true)
    };
    let mut found = Found {
        before: before.clone(),
        steps: Vec::new(),
        after: before.clone(),
        trials: 1,
        compared: Vec::new(),
    };
    let mut search = Search { subject, bench, trials: 1, compared: Vec::new() };
    let (mut now, mut score) = (setup.clone(), before);
    while found.steps.len() < MOST {
        let told: Vec<&Mistake> = found.steps.iter().map(|s| &s.mistake).collect();
        let is_fine = score.as_ref().is_some_and(fine);
        // A calibrated model that explains its recordings is not doubted: whoever asks has `aurt check`.
        if is_fine && matches!(thorough, Thorough::AllJoints) {
            break;
        }
        let best =
            if is_fine { search.glance(&now, &told) } else { search.round(&now, score.as_ref(), &told) };
        let Some(best) = best else { break };
        if !search.is_better(&now, score.as_ref(), &best) || best.has_no_size() {
            break;
        }
        let mut setup = now;
        let last = best.mistakes.len() - 1;
        for (k, mistake) in best.mistakes.into_iter().enumerate() {
            setup = mistake.undone(&setup);
            let after = if k == last {
                best.score.clone()
            } else {
                bench.score(&setup).unwrap_or_else(|| best.score.clone())
            };
            let alike = if k == last { best.alike.clone() } else { Vec::new() };
            found.steps.push(Step { likelier: None, mistake, after, alike });
        }
        now = setup;
        score = Some(best.score);
    }
    if found.steps.len() > 1
        && let Some(last) = score.take()
    {
        score = Some(search.reconsidered(setup, &mut found.steps, last));
    }
    // To compare robots takes seconds, many times as long as a calibration: `run` leaves that to `check`.
    if found.steps.is_empty() && !matches!(thorough, Thorough::AllJoints) {
        let step = search.in_one(&now).or_else(|| search.likelier(&now));
        if let Some(step) = step {
            score = Some(step.after.clone());
            found.steps.push(step);
        }
    }
    (found.trials, found.compared) = (search.trials, search.compared);
    // What raises the error is no cure, whatever else it explains.
    let least = found.before.as_ref().map_or(f64::INFINITY, |b| b.total);
    if score.as_ref().is_none_or(|s| !is_explained(s.total) || s.total >= least) {
        found.steps.clear();
    } else {
        found.after = score;
    }
    found
}

impl Search<'_> {
    /// A mistake in one recording, told by how the others predict it.
    fn in_one(&mut self, setup: &Setup) -> Option<Step> {
        let one = in_one(self.bench, setup, &mut self.trials)?;
        let other = one.mistake.undone(&one.setup);
        if !self.is_told([&one.setup, &other], &one.mistake, one.evidence, one.errors)
            || !is_explained(one.errors[1])
        {
            return None;
        }
        let after = self.bench.score(&one.mistake.undone(setup))?;
        Some(Step { likelier: None, mistake: one.mistake, after, alike: Vec::new() })
    }

    /// Another robot or gravity, told by how much likelier it makes every recording.
    fn likelier(&mut self, setup: &Setup) -> Option<Step> {
        if !self.subject.compares_robots() {
            return None;
        }
        let now = self.bench.score(setup)?;
        let tried = likelier(self.subject, self.bench, setup, &mut self.trials);
        let most = tried.iter().max_by(|a, b| a.evidence.gain.total_cmp(&b.evidence.gain))?;
        let mut near: Vec<Mistake> = Vec::new();
        for one in tried.iter().filter(|one| !one.is_behind(most)) {
            let other = one.mistake.undone(setup);
            // What raises the error with plain friction is no cure.
            let errors = [now.total, self.bench.score(&other).map_or(WORST, |after| after.total)];
            if self.is_told([setup, &other], &one.mistake, one.evidence, errors) {
                near.push(one.mistake.clone());
            } else if one.mistake == most.mistake {
                return None;
            }
        }
        let mistake = near.first()?.clone();
        let after = self.bench.score(&mistake.undone(setup))?;
        Some(Step { likelier: Some((-most.evidence.gain).exp()), mistake, after, alike: near.split_off(1) })
    }

    /// Whether what was tried is told, after what is there.
    fn is_better(&mut self, now: &Setup, before: Option<&Score>, tried: &Tried) -> bool {
        let evidence = Evidence::of([(before, &tried.score)]);
        let Some((mistake, evidence)) = tried.mistakes.last().zip(evidence) else { return false };
        let errors = [before.map_or(WORST, |b| b.total), tried.score.total];
        self.is_told([now, &tried.setup], mistake, evidence, errors)
    }

    /// Whether a setup is told for another one: it makes what is held out likelier by enough, lowers the error, and makes stretches
    /// of recordings likelier too. Neither is by chance, and one of the two not even for the best of all that are tried.
    fn is_told(
        &mut self,
        [now, other]: [&Setup; 2],
        mistake: &Mistake,
        across: Evidence,
        errors: [f64; 2],
    ) -> bool {
        let is_enough = |e: &Evidence| e.gain >= LEAST_GAIN && e.is_sure(1);
        let bench = self.bench_for(mistake);
        let within = (is_enough(&across) && errors[1] < errors[0])
            .then(|| within(&bench, now, other, mistake.file()))
            .flatten();
        self.compared.push(Compared { mistake: mistake.clone(), across, within, errors });
        let Some(within) = within else { return false };
        // That friction comes late is known from within alone.
        let is_confirmed = if mistake.is_delay() { is_enough(&within) } else { within.is_sure(1) };
        let tried = TESTS * self.trials;
        is_confirmed
            && (across.is_sure(tried) || within.is_sure(tried))
            && self.is_alone(&bench, now, mistake)
    }

    /// What else than the mistake could explain the data: friction that builds up over a distance comes late, rotors and load make
    /// up for bodies that are elsewhere.
    fn bench_for(&self, mistake: &Mistake) -> Bench {
        match mistake {
            Mistake::Gravity { .. } | Mistake::Geometry { .. } => self.bench.comparing(),
            Mistake::Reading { what: Reading::Delay(_), .. } => self.bench.presliding(),
            Mistake::Reading { .. } => self.bench.clone(),
        }
    }

    /// Whether a mistake of one recording is none of the others: undone in these too, it would make each of them less likely. What
    /// friction does in all of them, like a delay, is none of one.
    fn is_alone(&self, bench: &Bench, now: &Setup, mistake: &Mistake) -> bool {
        let Mistake::Reading { what, file: Some(own) } = mistake else { return true };
        let others = now.files().into_iter().filter(|file| file != own).map(|file| {
            let as_well = Mistake::Reading { what: what.clone(), file: Some(file) };
            within(bench, now, &as_well.undone(now), Some(file))
        });
        others.flatten().all(|evidence| evidence.gain < 0.0)
    }

    /// The best that one more of the likely mistakes can do.
    fn glance(&mut self, setup: &Setup, told: &[&Mistake]) -> Option<Tried> {
        let likely = |m: &Mistake| is_likely(m) && !told.iter().any(|t| t.is_about_what(m));
        let mistakes: Vec<Mistake> = usual(self.subject, setup).into_iter().filter(likely).collect();
        let singles = self.all(setup, &mistakes, &[]);
        self.likeliest(&singles)
    }

    /// The best that one more mistake, or two, can do: of the whole setup, of one recording, in pairs.
    fn round(&mut self, setup: &Setup, now: Option<&Score>, told: &[&Mistake]) -> Option<Tried> {
        let least = now.map_or(f64::INFINITY, |s| s.total);
        let open = |m: &Mistake| !told.iter().any(|t| t.is_about_what(m));
        let mistakes: Vec<Mistake> = usual(self.subject, setup).into_iter().filter(open).collect();
        let singles = self.all(setup, &mistakes, &[]);
        let mut best = self.likeliest(&singles);
        if best.as_ref().is_some_and(|b| self.is_better(setup, now, b)) {
            return best.map(|b| self.refined(setup, b));
        }
        let files = setup.files();
        if files.len() > 1 {
            let joints = setup.moving_joints();
            let of_files: Vec<Mistake> =
                files.iter().flat_map(|f| of_file(joints, *f)).filter(open).collect();
            let tried = self.all(setup, &of_files, &[]);
            best = better(best, self.likeliest(&tried));
        }
        if best.as_ref().is_some_and(|b| self.is_better(setup, now, b)) || least < PAIRS_FROM {
            return best.map(|b| self.refined(setup, b));
        }
        let mut first: Vec<&Tried> = singles.iter().collect();
        first.sort_by(|a, b| a.score.total.total_cmp(&b.score.total));
        let likely: Vec<Mistake> = mistakes.iter().filter(|m| is_likely(m)).cloned().collect();
        let mut pairs = Vec::new();
        for one in first.into_iter().take(PAIRED) {
            let others: Vec<Mistake> =
                likely.iter().filter(|m| !one.mistakes[0].is_about_what(m)).cloned().collect();
            pairs.extend(self.all(&one.setup, &others, &one.mistakes));
        }
        let single = best.as_ref().map(|b| (&b.setup, &b.score));
        let pair = self
            .likeliest(&pairs)
            .filter(|p| single.is_none_or(|(s, score)| self.is_better(s, Some(score), p)));
        pair.or(best).map(|b| self.refined(setup, b))
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

    fn all(&mut self, setup: &Setup, mistakes: &[Mistake], before: &[Mistake]) -> Vec<Tried> {
        self.trials += mistakes.len();
        // What does not change is prepared once.
        setup.parts.iter().for_each(|p| drop(p.prepared()));
        mistakes
            .par_iter()
            .filter_map(|mistake| {
                let setup = mistake.undone(setup);
                let score = self.bench.score(&setup)?;
                let mistakes = before.iter().chain([mistake]).cloned().collect();
                Some(Tried { mistakes, setup, score, alike: Vec::new() })
            })
            .collect()
    }

    /// The first of those that are nearly the best, with the rest of these.
    fn likeliest(&self, tried: &[Tried]) -> Option<Tried> {
        let least = tried.iter().map(|t| t.score.total).min_by(f64::total_cmp)?;
        let mut near = tried.iter().filter(|t| t.score.total <= ALIKE * least);
        let first = near.next()?;
        let alike = near.filter_map(|t| t.mistakes.last().cloned()).collect();
        Some(Tried {
            mistakes: first.mistakes.clone(),
            setup: first.setup.clone(),
            score: first.score.clone(),
            alike,
        })
    }

    /// The same with numbers that were tried coarsely fitted.
    fn refined(&mut self, setup: &Setup, tried: Tried) -> Tried {
        let coarse = (tried.mistakes.clone(), tried.setup.clone(), tried.score.clone());
        let mut best = tried;
        for at in 0..best.mistakes.len() {
            let mut step = 1.0;
            for _ in 0..8 {
                let around = variations(&best.mistakes[at], step);
                step *= 0.6;
                let better = around.into_iter().filter_map(|changed| {
                    self.trials += 1;
                    let mut mistakes = best.mistakes.clone();
                    mistakes[at] = changed;
                    let setup = mistakes.iter().fold(setup.clone(), |s, m| m.undone(&s));
                    let score = self.bench.score(&setup)?;
                    Some(Tried { mistakes, setup, score, alike: best.alike.clone() })
                });
                let better = better.min_by(|a, b| a.score.total.total_cmp(&b.score.total));
                if let Some(better) = better.filter(|b| b.score.total < 0.995 * best.score.total) {
                    best = better;
                }
            }
        }
        // Round values are meant where fitted ones are hardly better.
        if best.score.total > ROUND * coarse.2.total {
            (best.mistakes, best.setup, best.score) = coarse;
        }
        best
    }
}

/// What was found must explain the data: with a larger error it is a setup that is wrong in another way.
fn is_explained(error: f64) -> bool {
    1.0 - error * error >= LEAST_EXPLAINED
}

fn better(a: Option<Tried>, b: Option<Tried>) -> Option<Tried> {
    match (a, b) {
        (Some(a), Some(b)) => Some(if b.score.total * ALIKE < a.score.total { b } else { a }),
        (a, b) => a.or(b),
    }
}

/// Neighbours of a number that was tried coarsely; `step` is 1 at first and falls.
fn variations(mistake: &Mistake, step: f64) -> Vec<Mistake> {
    match mistake {
        Mistake::Gravity { to_m_s2: g } if *g != [0.0; 3] => turned(*g, 0.35 * step),
        Mistake::Reading { what, file } => {
            let changed: Vec<Reading> = match what {
                Reading::Delay(d) => {
                    [1.0 - 0.4 * step, 1.0 + 0.4 * step].map(|f| Reading::Delay(d * f)).to_vec()
                }
                Reading::Gain { joint, factor } => [1.0 / (1.0 + 1.5 * step), 1.0 + 1.5 * step]
                    .map(|f| Reading::Gain { joint: *joint, factor: factor * f })
                    .to_vec(),
                Reading::Geared(ratio) => {
                    [1.0 / (1.0 + 0.2 * step), 1.0 + 0.2 * step].map(|f| Reading::Geared(ratio * f)).to_vec()
                }
                _ => Vec::new(),
            };
            changed.into_iter().map(|what| Mistake::Reading { what, file: *file }).collect()
        }
        _ => Vec::new(),
    }
}

/// Gravity turned by an angle to all sides.
fn turned(g: [f64; 3], angle_rad: f64) -> Vec<Mistake> {
    let size = g.iter().map(|v| v * v).sum::<f64>().sqrt();
    let mut all = Vec::new();
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let mut to = g;
            to[axis] += sign * size * angle_rad.tan();
            let length = to.iter().map(|v| v * v).sum::<f64>().sqrt();
            all.push(Mistake::Gravity { to_m_s2: to.map(|v| v * size / length) });
        }
    }
    all
}
