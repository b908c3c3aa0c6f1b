use rayon::prelude::*;

use crate::evidence::problem::{NestedFit, Problem};
use crate::hypotheses::group::Switch;
use crate::hypotheses::group::{Group, is_friction, kind, same_force};
use crate::hypotheses::registered::REGISTERED;
use crate::request::SelectionOptions;

/// A group that was accepted.
#[derive(Debug, Clone)]
pub struct Chosen {
    /// Index of the group.
    pub group: usize,
    /// Score lost when it is left out of the final model.
    pub score: f64,
    /// Log-MSE that each joint loses without it.
    pub joint_loss: Vec<f64>,
    /// Other groups that would do as well in its place, best first, with their scores.
    pub rivals: Vec<(usize, f64)>,
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

/// Shares of independent rows of each joint's residual, from switches and their coefficients.
pub type IndependentShares<'a> = dyn Fn(&[Switch], &[f64]) -> Vec<f64> + Sync + 'a;

/// A nested fit with the shares of independent rows of its residual.
struct Weighed {
    nested: NestedFit,
    shares: Vec<f64>,
}

/// Forward selection with replacement and removal, by cross-validation over blocks of time.
pub struct Selector<'a> {
    /// The moments.
    pub problem: &'a Problem,
    /// Baseline coefficients, always in the model.
    pub baseline: &'a [Switch],
    /// The hypotheses.
    pub groups: &'a [Group],
    /// Mean squared error of each joint that noise alone leaves; improvements below it do not count.
    pub floor: &'a [f64],
    /// Log of the ratio by which the baseline's error on the calibration recordings exceeds the floor.
    pub misfit: &'a [f64],
    /// Share of independent rows of each joint, from the autocorrelation of a residual with the given
    /// switches and coefficients.
    pub independent_share: &'a IndependentShares<'a>,
    /// Thresholds.
    pub options: &'a SelectionOptions,
}

impl Selector<'_> {
    /// Selects groups: forward until nothing helps, then replacement and removal, and forward again.
    #[must_use]
    pub fn run(&self, mut progress: impl FnMut(&str)) -> Selection {
        let before = self.mse(&self.fit(&[]), &[]);
        let mut chosen: Vec<usize> = Vec::new();
        let mut barred: Vec<usize> = Vec::new();
        for _ in 0..ROUNDS {
            let start = chosen.clone();
            self.forward(&mut chosen, &barred, &mut progress);
            self.replace(&mut chosen);
            self.split(&mut chosen);
            barred.extend(self.remove(&mut chosen, &before));
            if chosen == start {
                break;
            }
        }
        self.finish(chosen, before)
    }

    /// All coefficients of the model that was selected.
    #[must_use]
    pub fn final_switches(&self, selection: &Selection) -> Vec<Switch> {
        self.switches(&selection.chosen.iter().map(|c| c.group).collect::<Vec<_>>())
    }

    fn forward(&self, chosen: &mut Vec<usize>, barred: &[usize], progress: &mut impl FnMut(&str)) {
        while chosen.len() < self.options.most {
            let fit = self.fit(chosen);
            let now = self.mse(&fit, &[]);
            let ranked = self.rank(&fit, &now, |g| {
                !chosen.contains(&g) && !barred.contains(&g) && !self.is_repeated(g, chosen)
            });
            let ranked: Vec<(usize, f64)> = ranked
                .into_iter()
                .filter(|(g, _)| self.enough(*g, &now, &self.mse(&fit, &self.groups[*g].switches)))
                .collect();
            let Some(best) = self.frugal(&ranked) else { break };
            chosen.push(best);
            progress(&format!("found: {} on {:?}", self.groups[best].effect, self.groups[best].joints));
        }
    }

    /// Whether a group is a further one of what a joint can have but once: a law of friction with other shape
    /// parameters, a motor that turns with a further joint. Several of them mimic what is not among the candidates.
    fn is_repeated(&self, group: usize, chosen: &[usize]) -> bool {
        let own = &self.groups[group];
        if own.effect == "torque_ripple" || own.joints.len() > 2 {
            return false;
        }
        chosen.iter().map(|c| &self.groups[*c]).any(|other| {
            other.effect == own.effect
                && other.target_only() == own.target_only()
                && other.joints.iter().any(|j| own.joints.contains(j))
        })
    }

    fn switches(&self, chosen: &[usize]) -> Vec<Switch> {
        let mut all = self.baseline.to_vec();
        for group in chosen {
            for switch in &self.groups[*group].switches {
                if !all.iter().any(|s| s.column == switch.column && s.target_only == switch.target_only) {
                    all.push(*switch);
                }
            }
        }
        all
    }

    fn fit(&self, chosen: &[usize]) -> Weighed {
        let switches = self.switches(chosen);
        let plain = vec![1.0; self.problem.joints()];
        let first = self.problem.fit(&switches, &plain);
        let weights: Vec<f64> = (0..self.problem.joints())
            .map(|j| {
                let rows = self.problem.rows(j, false).max(1.0);
                let variance = (first.squared_errors[0][j] + first.squared_errors[1][j]) / rows;
                1.0 / variance.max(self.floor[j]).max(f64::MIN_POSITIVE)
            })
            .collect();
        let shares = (self.independent_share)(&switches, &first.coefficients);
        Weighed { nested: self.problem.nest(&switches, &weights), shares }
    }

    /// Held-out mean squared error of each joint over all rows.
    fn mse(&self, fit: &Weighed, group: &[Switch]) -> Vec<f64> {
        let [calibration, target] = self.problem.held_out(&fit.nested, group);
        (0..self.problem.joints())
            .map(|j| (calibration[j] + target[j]) / self.problem.rows(j, false).max(1.0))
            .collect()
    }

    /// Σ_j ½ n_eff log(before / after), both not below the floor.
    fn score(&self, fit: &Weighed, before: &[f64], after: &[f64]) -> f64 {
        (0..self.problem.joints()).map(|j| self.score_on(j, fit, before, after)).sum()
    }

    /// A joint's part of the score.
    fn score_on(&self, joint: usize, fit: &Weighed, before: &[f64], after: &[f64]) -> f64 {
        let effective = fit.shares[joint] * self.problem.rows(joint, false);
        0.5 * effective * self.log_ratio(joint, before[joint], after[joint])
    }

    /// Whether a group shows what it is named for: what sets it apart from simpler effects brings something by itself,
    /// and what ties two joints shows on both.
    fn is_itself(&self, group: usize, fit: &Weighed, before: &[f64], after: &[f64], score: f64) -> bool {
        let own = &self.groups[group];
        if own.is_tie()
            && own.joints.iter().any(|j| self.score_on(*j, fit, before, after) < self.options.score)
        {
            return false;
        }
        if own.accessory.is_empty() {
            return true;
        }
        let accessory = self.score(fit, before, &self.mse(fit, &own.accessory));
        score - accessory > self.options.score + self.options.share * accessory.max(0.0)
    }

    fn log_ratio(&self, joint: usize, before: f64, after: f64) -> f64 {
        let floor = self.floor[joint].max(f64::MIN_POSITIVE);
        (before.max(floor) / after.max(floor)).ln()
    }

    fn rank(&self, fit: &Weighed, now: &[f64], eligible: impl Fn(usize) -> bool + Sync) -> Vec<(usize, f64)> {
        let mut ranked: Vec<(usize, f64)> = (0..self.groups.len())
            .into_par_iter()
            .filter(|g| eligible(*g))
            .filter_map(|g| {
                let after = self.mse(fit, &self.groups[g].switches);
                let score = self.score(fit, now, &after);
                let counts = score.is_finite() && score > self.options.score;
                (counts && self.is_itself(g, fit, now, &after, score)).then_some((g, score))
            })
            .collect();
        ranked.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        ranked
    }

    /// Among the best and those as good, the one of fewest coefficients. Friction differs from day to day, so a
    /// change of anything else on one joint has to be clearly better than a change of its friction.
    fn frugal(&self, ranked: &[(usize, f64)]) -> Option<usize> {
        let (first, best) = *ranked.first()?;
        let near = best - (self.options.tie * best).max(2.0);
        let choice = ranked
            .iter()
            .filter(|(_, score)| *score >= near)
            // The vocabulary wins ties.
            .min_by_key(|(g, _)| (self.groups[*g].effect == REGISTERED, self.groups[*g].switches.len()))
            .map_or(first, |(g, _)| *g);
        let own = &self.groups[choice];
        if own.target_only() && !is_friction(own.effect) && own.joints.len() == 1 {
            let everyday = ranked.iter().find(|(g, score)| {
                let other = &self.groups[*g];
                other.target_only()
                    && is_friction(other.effect)
                    && other.joints == own.joints
                    && *score >= self.options.everyday * best
            });
            return everyday.map(|(g, _)| *g).or(Some(choice));
        }
        Some(choice)
    }

    /// Whether a group lowers the error of some joint by as much as its kind must.
    fn enough(&self, group: usize, before: &[f64], after: &[f64]) -> bool {
        (0..before.len()).any(|j| self.log_ratio(j, before[j], after[j]) > self.least(group, j))
    }

    /// The log-MSE that a group must bring at a joint.
    fn least(&self, group: usize, joint: usize) -> f64 {
        let least = -(1.0 - self.options.reduction).ln();
        let group = &self.groups[group];
        if group.target_only() && !is_friction(group.effect) {
            least + self.options.change_share * self.misfit[joint]
        } else {
            least
        }
    }

    /// Tries for each chosen group whether another on its joints does better in its place.
    fn replace(&self, chosen: &mut [usize]) {
        for i in 0..chosen.len() {
            let rest = without(chosen, i);
            let fit = self.fit(&rest);
            let now = self.mse(&fit, &[]);
            let ranked = self.rank(&fit, &now, |g| {
                !rest.contains(&g) && self.meet(g, chosen[i]) && !self.is_repeated(g, &rest)
            });
            if let Some(best) = self.frugal(&ranked) {
                chosen[i] = best;
            }
        }
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
            let before = self.mse(&fit, &[]);
            let tied = self.mse(&fit, &tie.switches);
            for joint in &tie.joints {
                let fit = self.fit(&parts);
                let now = self.mse(&fit, &[]);
                let alone = |g: usize| {
                    self.groups[g].joints == [*joint] && !parts.contains(&g) && !self.is_repeated(g, &parts)
                };
                let best = self.frugal(&self.rank(&fit, &now, alone));
                parts.extend(best);
            }
            let apart = self.mse(&self.fit(&parts), &[]);
            let (tied, apart) = (self.score(&fit, &before, &tied), self.score(&fit, &before, &apart));
            if parts.len() > chosen.len() - 1 && apart >= tied - (self.options.tie * tied).max(2.0) {
                *chosen = parts;
                i = 0;
            } else {
                i += 1;
            }
        }
    }

    /// Whether two groups concern a common joint.
    fn meet(&self, a: usize, b: usize) -> bool {
        self.groups[a].joints.iter().any(|j| self.groups[b].joints.contains(j))
    }

    /// Removes groups that bring too little to the whole, the weakest first; those removed.
    fn remove(&self, chosen: &mut Vec<usize>, before: &[f64]) -> Vec<usize> {
        let mut removed = Vec::new();
        loop {
            let full = self.mse(&self.fit(chosen), &[]);
            let weakest = (0..chosen.len())
                .into_par_iter()
                .filter_map(|i| {
                    let (score, joint_loss) = self.loss(chosen, i, &full);
                    (!self.earns_its_place(chosen, i, before, &full, score, &joint_loss))
                        .then_some((i, score))
                })
                .min_by(|a, b| a.1.total_cmp(&b.1));
            match weakest {
                Some((i, _)) => removed.push(chosen.remove(i)),
                None => return removed,
            }
        }
    }

    fn loss(&self, chosen: &[usize], i: usize, full: &[f64]) -> (f64, Vec<f64>) {
        let fit = self.fit(&without(chosen, i));
        let without = self.mse(&fit, &[]);
        let joint_loss = (0..full.len()).map(|j| self.log_ratio(j, without[j], full[j])).collect();
        (self.score(&fit, &without, full), joint_loss)
    }

    fn earns_its_place(
        &self,
        chosen: &[usize],
        i: usize,
        before: &[f64],
        full: &[f64],
        score: f64,
        joint_loss: &[f64],
    ) -> bool {
        let own = &self.groups[chosen[i]];
        let twin = chosen.iter().enumerate().any(|(k, g)| {
            k != i && self.groups[*g].joints == own.joints && kind(self.groups[*g].effect) == kind(own.effect)
        });
        let share = if twin { self.options.share_same_kind } else { self.options.share };
        score > self.options.score
            && joint_loss.iter().enumerate().any(|(j, loss)| {
                let gain = self.log_ratio(j, before[j], full[j]);
                *loss > share * gain && *loss > self.least(chosen[i], j)
            })
    }

    fn finish(&self, chosen: Vec<usize>, before: Vec<f64>) -> Selection {
        let full = self.mse(&self.fit(&chosen), &[]);
        let mut found: Vec<Chosen> = (0..chosen.len())
            .map(|i| {
                let (score, joint_loss) = self.loss(&chosen, i, &full);
                let rest = without(&chosen, i);
                let fit = self.fit(&rest);
                let now = self.mse(&fit, &[]);
                let own = &self.groups[chosen[i]];
                let rivals = self
                    .rank(&fit, &now, |g| !rest.contains(&g) && self.meet(g, chosen[i]))
                    .into_iter()
                    .filter(|(g, s)| {
                        // One with more coefficients that does no better contains the chosen one, unless it is the
                        // same force in other coordinates.
                        let other = &self.groups[*g];
                        (other.switches.len() <= own.switches.len() || same_force(other.effect, own.effect))
                            && self.groups[*g].effect != own.effect
                            && *s >= score - (self.options.tie * score).max(2.0)
                    })
                    .collect();
                Chosen { group: chosen[i], score, joint_loss, rivals }
            })
            .collect();
        found.sort_by(|a, b| b.score.total_cmp(&a.score));
        Selection { chosen: found, before, after: full }
    }
}

/// Rounds of forward selection, replacement and removal.
const ROUNDS: usize = 3;

/// All but the i-th.
fn without(chosen: &[usize], i: usize) -> Vec<usize> {
    chosen.iter().enumerate().filter(|(k, _)| *k != i).map(|(_, g)| *g).collect()
}
