use rayon::prelude::*;

use crate::hypotheses::group::{Group, Switch};
use crate::request::SelectionOptions;
use crate::search::ground::{Beside, Ground};
use crate::search::scoring::{Loss, Scoring, Weighed, without};

/// A group that was accepted.
#[derive(Debug, Clone)]
pub struct Chosen {
    /// Index of the group.
    pub group: usize,
    /// Score lost when it is left out of the final model.
    pub score: f64,
    /// What the score had to exceed.
    pub threshold: f64,
    /// Probability that a search reaches such a score on its joints by chance.
    pub p_null: Option<f64>,
    /// Probability that rows which nothing was fitted to favour it as much by chance.
    pub p_confirm: Option<f64>,
    /// Log-MSE that each joint loses without it.
    pub joint_loss: Vec<f64>,
    /// Why it is not claimed though it passed every test, in words: it stays in the model, lest something else takes its place.
    pub withheld: Option<String>,
    /// Other groups that could stand in its place, best first.
    pub rivals: Vec<Rival>,
}

impl Chosen {
    /// The probability that chance alone makes such a finding. It has to hold both in the rows that it was found in and in
    /// those that nothing was fitted to, so that the larger of the two probabilities decides (R. L. Berger, *Technometrics* 24,
    /// 1982): what fits some recordings only is nothing that the robot has.
    pub fn by_chance(&self) -> Option<f64> {
        match (self.p_null, self.p_confirm) {
            (Some(search), Some(confirmed)) => Some(search.max(confirmed)),
            (one, other) => one.or(other),
        }
    }
}

/// A group that could stand in the place of another.
#[derive(Debug, Clone, Copy)]
pub struct Rival {
    /// Index of the group.
    pub group: usize,
    pub score: f64,
    /// Whether it scores as well but for a tie.
    pub as_good: bool,
    /// Whether blocks of time leave open which of the two is better.
    pub open: bool,
}

/// What selection found.
#[derive(Debug, Clone)]
pub struct Selection {
    /// The accepted groups, strongest first.
    pub chosen: Vec<Chosen>,
    /// Held-out squared error per row before, of the rows in question, joint by joint.
    pub before: Vec<f64>,
    /// The same with the chosen groups.
    pub after: Vec<f64>,
}

/// Forward selection with replacement and removal, by cross-validation over blocks of time. Shapes of a law are
/// estimated when it is taken, and once more at the end.
pub struct Selector<'a> {
    /// The data.
    pub ground: &'a mut dyn Ground,
    /// Baseline coefficients, always in the model.
    pub baseline: &'a [Switch],
    /// The hypotheses.
    pub groups: &'a [Group],
    /// Mean squared error of each joint that noise alone leaves; improvements below it do not count.
    pub floor: &'a [f64],
    /// Thresholds.
    pub options: &'a SelectionOptions,
}

impl Selector<'_> {
    /// The same data and thresholds with another baseline and other hypotheses.
    pub(crate) fn asking<'b>(&'b mut self, baseline: &'b [Switch], groups: &'b [Group]) -> Selector<'b> {
        Selector { ground: &mut *self.ground, baseline, groups, floor: self.floor, options: self.options }
    }

    pub(crate) fn scoring(&self) -> Scoring<'_> {
        Scoring {
            ground: &*self.ground,
            baseline: self.baseline,
            groups: self.groups,
            floor: self.floor,
            options: self.options,
            chance: None,
        }
    }

    /// Selects groups: forward until nothing helps, then replacement and removal, and forward again.
    pub fn run(&mut self, progress: impl FnMut(&str)) -> Selection {
        self.run_from(Vec::new(), progress)
    }

    /// The same, begun with some groups in the model.
    pub(crate) fn run_from(&mut self, mut chosen: Vec<usize>, mut progress: impl FnMut(&str)) -> Selection {
        let before = self.scoring().fit(&[]).errors;
        let mut barred: Vec<usize> = Vec::new();
        for _ in 0..self.options.rounds {
            let start = chosen.clone();
            self.forward(&mut chosen, &barred, &mut progress);
            self.replace(&mut chosen);
            self.scoring().split(&mut chosen);
            self.scoring().join(&mut chosen);
            barred.extend(self.scoring().remove(&mut chosen, &before));
            if chosen == start {
                break;
            }
        }
        for group in chosen.clone() {
            self.estimate(group, &chosen, true);
        }
        self.scoring().remove(&mut chosen, &before);
        self.scoring().beyond_chance(&mut chosen, before)
    }

    /// All coefficients of the model that was selected.
    pub fn final_switches(&self, selection: &Selection) -> Vec<Switch> {
        self.scoring().switches(&selection.chosen.iter().map(|c| c.group).collect::<Vec<_>>())
    }

    fn forward(&mut self, chosen: &mut Vec<usize>, barred: &[usize], progress: &mut impl FnMut(&str)) {
        while chosen.len() < self.options.most {
            let Some(best) = self.next(chosen, barred) else { break };
            chosen.push(best);
            progress(&format!("found: {} on {:?}", self.groups[best].effect.id, self.groups[best].joints));
        }
    }

    /// The group that comes next. What it and the best of other effects on its joints can do with their shapes is
    /// found out first: a law that lies between two starts must not lose to an imitation that does not.
    fn next(&mut self, chosen: &[usize], barred: &[usize]) -> Option<usize> {
        let scoring = self.scoring();
        let fit = scoring.fit(chosen);
        let ranked: Vec<(usize, f64)> = scoring
            .rank(&fit, |g| !chosen.contains(&g) && !barred.contains(&g) && !scoring.is_repeated(g, chosen))
            .into_iter()
            .filter(|(g, _)| scoring.enough(*g, &fit))
            .collect();
        let best = scoring.frugal(&fit, &ranked)?;
        let contenders = scoring.contenders(best, &ranked);
        let mut moved = false;
        for group in contenders {
            moved |= self.estimate(group, chosen, false);
        }
        if !moved {
            return Some(best);
        }
        let scoring = self.scoring();
        let among = |g: usize| ranked.iter().any(|(r, _)| *r == g) && scoring.meet(g, best);
        scoring.frugal(&fit, &scoring.rank(&fit, among)).or(Some(best))
    }

    /// Estimates the shapes of a group beside the chosen ones; whether they have moved.
    fn estimate(&mut self, group: usize, chosen: &[usize], deviations: bool) -> bool {
        let rest: Vec<usize> = chosen.iter().copied().filter(|g| *g != group).collect();
        let switches = self.scoring().switches(&rest);
        let mut all = switches.clone();
        all.extend(&self.groups[group].switches);
        let problem = self.ground.problem();
        let (coefficients, _) = problem.least_squares(&all, &vec![1.0; problem.joints()]);
        let shares = self.ground.independent_shares(&all, &coefficients);
        let beside = Beside { switches: &switches, floor: self.floor, shares: &shares, deviations };
        self.ground.estimate(&self.groups[group], &beside)
    }

    /// Tries for each chosen group whether another on its joints does better in its place.
    fn replace(&mut self, chosen: &mut [usize]) {
        for i in 0..chosen.len() {
            let rest = without(chosen, i);
            let scoring = self.scoring();
            let fit = scoring.fit(&rest);
            let ranked = scoring.rank(&fit, |g| {
                !rest.contains(&g) && scoring.meet(g, chosen[i]) && !scoring.is_repeated(g, &rest)
            });
            if let Some(best) = scoring.frugal(&fit, &ranked) {
                chosen[i] = best;
            }
            // Beside what was found later, other shapes can be better.
            self.estimate(chosen[i], &rest, false);
        }
    }
}

impl Scoring<'_> {
    /// The best, and the best of other effects that come near it on one of its joints.
    fn contenders(&self, best: usize, ranked: &[(usize, f64)]) -> Vec<usize> {
        let score = ranked.first().map_or(0.0, |r| r.1);
        let mut contenders = vec![best];
        for (g, own) in ranked {
            let known = contenders.iter().any(|c| self.groups[*c].effect == self.groups[*g].effect);
            if !known && self.meet(*g, best) && *own >= self.options.contender * score {
                contenders.push(*g);
            }
        }
        contenders
    }

    /// Replaces effects that tie two joints by an effect on each, where these do as well: what two joints do by
    /// themselves needs no coupling.
    fn split(&self, chosen: &mut Vec<usize>) {
        let mut i = 0;
        while i < chosen.len() {
            let tie = &self.groups[chosen[i]];
            if !tie.is_tie() {
                i += 1;
                continue;
            }
            let mut parts = without(chosen, i);
            let fit = self.fit(&parts);
            let tied = self.with(&fit, &tie.switches);
            for joint in &tie.joints {
                let alone = |g: usize| {
                    self.groups[g].joints == [*joint] && !parts.contains(&g) && !self.is_repeated(g, &parts)
                };
                let fit = self.fit(&parts);
                let best = self.frugal(&fit, &self.rank(&fit, alone));
                parts.extend(best);
            }
            let apart = self.fit(&parts).errors;
            let before = &fit.errors;
            let (tied, apart) = (self.score(&fit, before, &tied), self.score(&fit, before, &apart));
            if parts.len() > chosen.len() - 1 && apart >= self.near(tied) {
                *chosen = parts;
                i = 0;
            } else {
                i += 1;
            }
        }
    }

    /// Replaces two effects on the same joints by one of as many coefficients that does as well, and better than either of the two
    /// alone: more Coulomb friction and more viscous friction are friction at another level.
    fn join(&self, chosen: &mut Vec<usize>) {
        let alike = |a: &Group, b: &Group| a.joints == b.joints && a.target_only() == b.target_only();
        let mut pairs = (0..chosen.len()).flat_map(|i| (i + 1..chosen.len()).map(move |k| (i, k)));
        let joined = pairs.find_map(|(i, k)| {
            let (one, other) = (&self.groups[chosen[i]], &self.groups[chosen[k]]);
            if !alike(one, other) {
                return None;
            }
            let rest = without(&without(chosen, k), i);
            let fit = self.fit(&rest);
            let apart: Vec<Switch> = one.switches.iter().chain(&other.switches).copied().collect();
            let before = &fit.errors;
            let score = |switches: &[Switch]| self.score(&fit, before, &self.with(&fit, switches));
            let alone = score(&one.switches).max(score(&other.switches));
            let least = self.near(score(&apart)).max(alone + self.options.score);
            let both = |g: usize| {
                let own = &self.groups[g];
                own.is_named() && alike(own, one) && own.switches.len() == apart.len() && !chosen.contains(&g)
            };
            let ranked = self.rank(&fit, |g| both(g) && !self.is_repeated(g, &rest));
            let best = ranked.first().filter(|(_, score)| *score >= least)?.0;
            Some(rest.into_iter().chain([best]).collect())
        });
        if let Some(joined) = joined {
            *chosen = joined;
        }
    }

    /// Removes groups that bring too little to the whole, the weakest first; those removed.
    pub(crate) fn remove(&self, chosen: &mut Vec<usize>, before: &[f64]) -> Vec<usize> {
        let mut removed = Vec::new();
        loop {
            let full = self.fit(chosen);
            // What a change is asked about is what structure leaves.
            let structure: Vec<usize> =
                chosen.iter().copied().filter(|g| !self.groups[*g].target_only()).collect();
            let left = if structure.len() < chosen.len() && !structure.is_empty() {
                self.fit(&structure).errors
            } else {
                before.to_vec()
            };
            let weakest = (0..chosen.len())
                .into_par_iter()
                .filter_map(|i| {
                    let loss = self.loss(chosen, i, &full);
                    let start = if self.groups[chosen[i]].target_only() { &left } else { before };
                    let stays = self.earns_its_place(chosen, i, start, &full, &loss);
                    (!stays).then_some((i, loss.score))
                })
                .min_by(|a, b| a.1.total_cmp(&b.1));
            match weakest {
                Some((i, _)) => removed.push(chosen.remove(i)),
                None => return removed,
            }
        }
    }

    /// Keeps of the chosen what chance does not reach beside them with the best of all hypotheses on their joints.
    fn beyond_chance(&self, chosen: &mut Vec<usize>, before: Vec<f64>) -> Selection {
        if chosen.is_empty() {
            return self.finish(chosen, before);
        }
        let switches = self.switches(chosen);
        let chance = self.ground.scores_by_chance(self.groups, &switches, self.floor, self.options);
        let raised = Scoring { chance: Some(&chance), ..*self };
        raised.remove(chosen, &before);
        raised.finish(chosen, before)
    }

    fn finish(&self, chosen: &[usize], before: Vec<f64>) -> Selection {
        let full = self.fit(chosen);
        let mut found: Vec<Chosen> = (0..chosen.len())
            .map(|i| {
                let Loss { score, of_joint, without } = self.loss(chosen, i, &full);
                let rivals = self.rivals(chosen, i, score, &without);
                Chosen {
                    group: chosen[i],
                    score,
                    threshold: self.threshold(chosen[i]),
                    p_null: self.p_null(chosen[i], score),
                    p_confirm: None,
                    joint_loss: of_joint,
                    withheld: None,
                    rivals,
                }
            })
            .collect();
        found.sort_by(|a, b| b.score.total_cmp(&a.score));
        Selection { chosen: found, before, after: full.errors }
    }

    /// Groups of other effects that do as well as the i-th of the chosen, or of which the data leave open whether they do. One
    /// that has more coefficients and more parameters and does no better contains the chosen one, unless it is the same force in
    /// other coordinates.
    pub(crate) fn rivals(&self, chosen: &[usize], i: usize, score: f64, fit: &Weighed) -> Vec<Rival> {
        let own = &self.groups[chosen[i]];
        let rest = without(chosen, i);
        let near = self.near(score);
        let other = |g: &usize| {
            let other = &self.groups[*g];
            let is_simple = other.switches.len() <= own.switches.len() || other.freedoms() <= own.freedoms();
            (is_simple || other.effect.is_same_force(own.effect)) && other.effect != own.effect
        };
        let ranked = self.rank(fit, |g| !rest.contains(&g) && self.meet(g, chosen[i]) && other(&g));
        let rival = |(group, score)| Rival {
            group,
            score,
            as_good: score >= near,
            open: self.leaves_open(fit, chosen[i], group),
        };
        ranked.into_iter().map(rival).filter(|r| r.as_good || r.open).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::Chosen;

    #[test]
    fn what_held_out_rows_do_not_confirm_is_chance() {
        let chosen = |p_null, p_confirm| Chosen {
            group: 0,
            score: 100.0,
            threshold: 8.0,
            p_null,
            p_confirm,
            joint_loss: Vec::new(),
            withheld: None,
            rivals: Vec::new(),
        };
        assert_eq!(chosen(Some(1e-9), Some(0.7)).by_chance(), Some(0.7));
        assert_eq!(chosen(Some(0.3), Some(0.001)).by_chance(), Some(0.3));
        assert_eq!(chosen(Some(1e-9), None).by_chance(), Some(1e-9));
    }
}
