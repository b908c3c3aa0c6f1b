//! What a hypothesis brings to a model, on blocks of time that did not fit it.

use aurt_calibration::{ONE_SIDED_5, student};
use rayon::prelude::*;

use crate::evidence::chance::Chance;
use crate::evidence::nested::NestedFit;
use crate::hypotheses::group::{Group, Switch};
use crate::request::SelectionOptions;
use crate::search::ground::Ground;

/// A nested fit with the shares of independent rows of its residual, and what it leaves.
pub(crate) struct Weighed {
    nested: NestedFit,
    /// Share of independent rows of each joint.
    pub(crate) shares: Vec<f64>,
    /// Held-out mean squared errors that it leaves, joint by joint.
    pub(crate) errors: Vec<f64>,
}

/// A group is judged on rows that it is not fitted to if on those that it is fitted to it brings this share of the least
/// score. A fit usually brings more there than on held-out rows; where an unstable one does not, half is left for it. This
/// saves time and decides nothing else: 0 tries all groups that bring anything.
const IN_SAMPLE: f64 = 0.5;

/// What chance reaches in every second search is not put to the test of held-out rows: a number of choice, so that what is
/// no finding does not fill the model beside which findings are tested.
const EVERY_SECOND: f64 = 0.5;

/// Scores of hypotheses beside a model.
#[derive(Clone, Copy)]
pub(crate) struct Scoring<'a> {
    pub(crate) ground: &'a dyn Ground,
    pub(crate) baseline: &'a [Switch],
    pub(crate) groups: &'a [Group],
    pub(crate) floor: &'a [f64],
    pub(crate) options: &'a SelectionOptions,
    /// What chance reaches, where it is known.
    pub(crate) chance: Option<&'a Chance>,
}

impl Scoring<'_> {
    /// What the score of a group that stays has to exceed.
    pub(crate) fn threshold(&self, group: usize) -> f64 {
        let of = |chance: &Chance| chance.score(&self.groups[group].joints, EVERY_SECOND);
        self.options.score.max(self.chance.map_or(0.0, of))
    }

    /// The probability that a search reaches a score on the group's joints by chance.
    pub(crate) fn p_null(&self, group: usize, score: f64) -> Option<f64> {
        self.chance.and_then(|chance| chance.probability(&self.groups[group].joints, score))
    }

    /// The baseline's switches and those of chosen groups, each once.
    pub(crate) fn switches(&self, chosen: &[usize]) -> Vec<Switch> {
        let mut all = self.baseline.to_vec();
        for switch in chosen.iter().flat_map(|g| &self.groups[*g].switches) {
            if !all.iter().any(|s| s.column == switch.column && s.target_only == switch.target_only) {
                all.push(*switch);
            }
        }
        all
    }

    /// Fits a model: least squares for the joints' variances, then weighted by them. Independent rows are those of its residual.
    pub(crate) fn fit(&self, chosen: &[usize]) -> Weighed {
        let switches = self.switches(chosen);
        let (coefficients, weights) = self.least_squares(&switches);
        let shares = self.ground.independent_shares(&switches, &coefficients);
        self.nested(&switches, &weights, shares)
    }

    /// The same with the independent rows of a larger model's residual: what a group explains is no noise, and a strong one
    /// that lasts would leave few rows to show it.
    fn fit_within(&self, chosen: &[usize], larger: &Weighed) -> Weighed {
        let switches = self.switches(chosen);
        let (_, weights) = self.least_squares(&switches);
        self.nested(&switches, &weights, larger.shares.clone())
    }

    /// Coefficients of a model, and weights by what it leaves of each joint.
    fn least_squares(&self, switches: &[Switch]) -> (Vec<f64>, Vec<f64>) {
        let problem = self.ground.problem();
        let (coefficients, squared_errors) = problem.least_squares(switches, &vec![1.0; problem.joints()]);
        let weights = problem.weights(&squared_errors, self.floor);
        (coefficients, weights)
    }

    fn nested(&self, switches: &[Switch], weights: &[f64], shares: Vec<f64>) -> Weighed {
        let problem = self.ground.problem();
        let nested = problem.nest(switches, weights);
        let errors = self.mean(&problem.held_out_in_all(&nested, &[]));
        Weighed { nested, shares, errors }
    }

    /// What a fit leaves once it is extended by a group.
    pub(crate) fn with(&self, fit: &Weighed, group: &[Switch]) -> Vec<f64> {
        self.mean(&self.ground.problem().held_out_in_all(&fit.nested, group))
    }

    fn mean(&self, sums: &[f64]) -> Vec<f64> {
        let rows = |j: usize| self.ground.problem().rows(j, false).max(1.0);
        sums.iter().enumerate().map(|(j, sum)| sum / rows(j)).collect()
    }

    /// Whether a group fits the rows that it is fitted to better. Most do not by anything that counts, and to see that
    /// is a sixth of the work of judging it on blocks that it is not fitted to.
    fn may_count(&self, fit: &Weighed, before: &[f64], group: &[Switch]) -> bool {
        let problem = self.ground.problem();
        let after = problem.in_sample(&fit.nested, group);
        let of_joint = |j: usize| {
            let effective = fit.shares[j] * problem.rows(j, false);
            let ratio = before[j].max(f64::MIN_POSITIVE) / after[j].max(f64::MIN_POSITIVE);
            0.5 * effective * ratio.ln().max(0.0)
        };
        (0..after.len()).map(of_joint).sum::<f64>() > IN_SAMPLE * self.options.score
    }

    /// Σ_j ½ n_eff log(before / after), both not below the floor.
    pub(crate) fn score(&self, fit: &Weighed, before: &[f64], after: &[f64]) -> f64 {
        (0..before.len()).map(|j| self.score_on(j, fit, before, after)).sum()
    }

    /// A joint's part of the score.
    fn score_on(&self, joint: usize, fit: &Weighed, before: &[f64], after: &[f64]) -> f64 {
        let effective = fit.shares[joint] * self.ground.problem().rows(joint, false);
        0.5 * effective * self.log_ratio(joint, before[joint], after[joint])
    }

    /// log(before / after), both not below the floor.
    pub(crate) fn log_ratio(&self, joint: usize, before: f64, after: f64) -> f64 {
        let floor = self.floor[joint].max(f64::MIN_POSITIVE);
        (before.max(floor) / after.max(floor)).ln()
    }

    /// Whether a group shows what it is named for: what sets it apart from simpler effects brings something by itself,
    /// and what ties two joints shows on both.
    fn is_itself(&self, group: usize, fit: &Weighed, after: &[f64], score: f64) -> bool {
        let (own, before) = (&self.groups[group], &fit.errors);
        let hidden = |j: &usize| self.score_on(*j, fit, before, after) < self.options.score;
        if own.is_tie() && own.joints.iter().any(hidden) {
            return false;
        }
        if own.accessory.is_empty() {
            return true;
        }
        let accessory = self.score(fit, before, &self.with(fit, &own.accessory));
        score - accessory > self.options.score + self.options.share * accessory.max(0.0)
    }

    /// Groups that bring the least score beside a fit, best first.
    pub(crate) fn rank(&self, fit: &Weighed, eligible: impl Fn(usize) -> bool + Sync) -> Vec<(usize, f64)> {
        let in_sample = self.ground.problem().in_sample(&fit.nested, &[]);
        let mut ranked: Vec<(usize, f64)> = (0..self.groups.len())
            .into_par_iter()
            .filter(|g| eligible(*g) && self.may_count(fit, &in_sample, &self.groups[*g].switches))
            .filter_map(|g| {
                let after = self.with(fit, &self.groups[g].switches);
                let score = self.score(fit, &fit.errors, &after);
                let counts = score.is_finite() && score > self.options.score;
                (counts && self.is_itself(g, fit, &after, score)).then_some((g, score))
            })
            .collect();
        ranked.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        ranked
    }

    /// Scores within this of the best are as good.
    pub(crate) fn near(&self, best: f64) -> f64 {
        best - (self.options.tie * best).max(self.options.tie_nats)
    }

    /// The question which of two groups is better, left open by blocks of time that were not fitted to: the sum over blocks of the
    /// difference of their log-likelihoods is fewer of its deviations than Student's t says with 95 %.
    ///
    /// As in Q. H. Vuong's test (*Econometrica* 57, 1989), but given the motion. If the better one is true, a block's difference is
    /// Σd² + 2Σde, with d what both predict differently and e the error: d is known, and 2Σde alone is uncertain. A motion in which
    /// few blocks tell the two apart decides by these; they are then the degrees of freedom (F. E. Satterthwaite, *Biometrics
    /// Bulletin* 2, 1946).
    pub(crate) fn leaves_open(&self, fit: &Weighed, group: usize, rival: usize) -> bool {
        let problem = self.ground.problem();
        let [of_group, of_rival] = [group, rival].map(|g| &self.groups[g].switches[..]);
        let [own, other] = [of_group, of_rival].map(|g| problem.held_out_by_block(&fit.nested, g));
        let rows: Vec<f64> = (0..problem.joints()).map(|j| problem.rows(j, false).max(1.0)).collect();
        let per_square = |j: usize| {
            let left = own.iter().map(|block| block[j]).sum::<f64>() / rows[j];
            0.5 * fit.shares[j] / left.max(self.floor[j]).max(f64::MIN_POSITIVE)
        };
        let weights: Vec<f64> = (0..problem.joints()).map(per_square).collect();
        let apart = problem.apart_by_block(&fit.nested, of_group, of_rival, &weights);
        let worse = |(own, other): (&Vec<f64>, &Vec<f64>)| -> f64 {
            own.iter().zip(other).zip(&weights).map(|((own, other), w)| w * (other - own)).sum()
        };
        let blocks: Vec<[f64; 2]> =
            own.iter().zip(&other).map(worse).zip(apart).map(|(worse, apart)| [worse, apart]).collect();
        // What is expected to tell no more than a tie does is one.
        let expected: f64 = blocks.iter().map(|[_, apart]| apart).sum();
        expected < self.options.tie_nats || !is_better(&blocks)
    }

    /// Among the best and those as good, of which the data leave open whether they are, the one of fewest parameters. A law gives way
    /// to a simpler one that suffices, unless it exceeds it by the least score and lowers the error of some joint by the least share.
    /// Friction differs from day to day, so a change of anything else on one joint has to be clearly better than a change of its friction.
    pub(crate) fn frugal(&self, fit: &Weighed, ranked: &[(usize, f64)]) -> Option<usize> {
        let (first, best) = *ranked.first()?;
        let near = self.near(best);
        // The vocabulary wins ties.
        let price = |g: usize| (!self.groups[g].is_named(), self.groups[g].freedoms());
        let as_good = ranked.iter().take_while(|(_, score)| *score >= near).map(|(g, _)| *g);
        let mut cheaper: Vec<usize> = as_good.filter(|g| price(*g) < price(first)).collect();
        cheaper.sort_by_key(|g| price(*g));
        let mut choice = cheaper.into_iter().find(|g| self.leaves_open(fit, first, *g)).unwrap_or(first);
        let suffices = |g: usize| self.enough(g, fit) && !self.adds_enough(choice, g, fit);
        let simpler = ranked.iter().find(|(g, score)| {
            self.groups[choice].generalises(&self.groups[*g])
                && (*score >= best - self.options.score || suffices(*g))
        });
        if let Some((g, _)) = simpler {
            choice = *g;
        }
        let own = &self.groups[choice];
        if own.target_only() && !own.effect.is_friction && own.joints.len() == 1 {
            let everyday = ranked.iter().find(|(g, score)| {
                let other = &self.groups[*g];
                other.target_only()
                    && other.effect.is_friction
                    && other.joints == own.joints
                    && *score >= self.options.everyday * best
                    && self.leaves_open(fit, choice, *g)
            });
            return everyday.map(|(g, _)| *g).or(Some(choice));
        }
        Some(choice)
    }

    /// True for a group that lowers the error of some joint by as much as it must.
    pub(crate) fn enough(&self, group: usize, fit: &Weighed) -> bool {
        self.lowers_enough(group, &fit.errors, fit)
    }

    /// True for a group that lowers what a simpler one leaves by as much as it must.
    fn adds_enough(&self, group: usize, simpler: usize, fit: &Weighed) -> bool {
        self.lowers_enough(group, &self.with(fit, &self.groups[simpler].switches), fit)
    }

    /// True for a group that leaves some joint an error below another by as much as it must bring.
    fn lowers_enough(&self, group: usize, before: &[f64], fit: &Weighed) -> bool {
        let after = self.with(fit, &self.groups[group].switches);
        (0..after.len()).any(|j| {
            let least = self.least(fit.shares[j]);
            self.log_ratio(j, before[j], after[j]) > least
        })
    }

    /// The log-MSE that a group must bring at a joint with a share of independent rows.
    fn least(&self, share: f64) -> f64 {
        self.options.least_log_error(share * self.ground.rows_per_s())
    }

    /// Whether a group is a further one of what a joint can have but once: a law of friction with other shape
    /// parameters, a motor that turns with a further joint. Several of them mimic what is not among the candidates.
    pub(crate) fn is_repeated(&self, group: usize, chosen: &[usize]) -> bool {
        let own = &self.groups[group];
        if own.effect.is_repeatable || own.joints.len() > 2 {
            return false;
        }
        chosen.iter().map(|c| &self.groups[*c]).any(|other| {
            other.effect == own.effect
                && other.target_only() == own.target_only()
                && other.joints.iter().any(|j| own.joints.contains(j))
        })
    }

    /// Whether two groups concern a common joint.
    pub(crate) fn meet(&self, a: usize, b: usize) -> bool {
        self.groups[a].joints.iter().any(|j| self.groups[b].joints.contains(j))
    }

    /// Score and log-MSE of each joint that are lost without the i-th of the chosen, whose model is `full`.
    pub(crate) fn loss(&self, chosen: &[usize], i: usize, full: &Weighed) -> Loss {
        let without = self.fit_within(&without(chosen, i), full);
        let (before, after) = (&without.errors, &full.errors);
        let of_joint = (0..after.len()).map(|j| self.log_ratio(j, before[j], after[j])).collect();
        Loss { score: self.score(&without, before, after), of_joint, without }
    }

    /// Whether the i-th of the chosen brings as much as it must: the least score, and on some joint the least reduction
    /// and a share of what there is to bring. Of a change that is what all changes gain on the joint, from `start`, what
    /// structure leaves. Of structure it is that as well, or what it would gain down to the noise from where the model
    /// stands without it, whichever is less: what others gain does not hide an effect that takes a good part of what they
    /// leave.
    pub(crate) fn earns_its_place(
        &self,
        chosen: &[usize],
        i: usize,
        start: &[f64],
        full: &Weighed,
        loss: &Loss,
    ) -> bool {
        let own = &self.groups[chosen[i]];
        let twin = chosen.iter().enumerate().any(|(k, g)| {
            k != i && self.groups[*g].joints == own.joints && self.groups[*g].effect.kind == own.effect.kind
        });
        let share = if twin { self.options.share_same_kind } else { self.options.share };
        loss.score > self.threshold(chosen[i])
            && loss.of_joint.iter().enumerate().any(|(j, of_joint)| {
                let gain = self.log_ratio(j, start[j], full.errors[j]);
                let least = self.least(full.shares[j]);
                let without = loss.without.errors[j];
                let left = if own.target_only() { gain } else { self.log_ratio(j, without, 0.0) };
                *of_joint > share * gain.min(left) && *of_joint > least
            })
    }
}

/// The test of differences of log-likelihoods, a block of time each, against none; beside each what the motion makes of it.
fn is_better(blocks: &[[f64; 2]]) -> bool {
    let sum = |of: &dyn Fn(&[f64; 2]) -> f64| blocks.iter().map(of).sum::<f64>();
    let deviation = sum(&|[worse, apart]| (worse - apart).powi(2)).sqrt();
    let freedom = sum(&|[_, apart]| *apart).powi(2) / sum(&|[_, apart]| apart * apart);
    let most = blocks.len().saturating_sub(1).max(1) as f64;
    // Two of the same errors give no number.
    let t = sum(&|[worse, _]| *worse) / deviation;
    freedom.is_finite() && t > student(ONE_SIDED_5, freedom.clamp(1.0, most))
}

/// What is lost without an effect.
pub(crate) struct Loss {
    pub(crate) score: f64,
    /// Log-MSE of each joint.
    pub(crate) of_joint: Vec<f64>,
    /// The model without it.
    pub(crate) without: Weighed,
}

/// All but the i-th.
pub(crate) fn without(chosen: &[usize], i: usize) -> Vec<usize> {
    chosen.iter().enumerate().filter(|(k, _)| *k != i).map(|(_, g)| *g).collect()
}

#[cfg(test)]
mod tests {
    use super::is_better;

    #[test]
    fn few_blocks_that_tell_two_laws_apart_decide() {
        let nothing = |k: i32| [if k % 2 == 0 { 0.3 } else { -0.25 }, 0.02];
        let with =
            |telling: &[[f64; 2]]| (0..20).map(nothing).chain(telling.iter().copied()).collect::<Vec<_>>();
        // As many nats as the motion promises, in two blocks of 22.
        assert!(is_better(&with(&[[30.0, 31.0], [12.0, 10.5]])));
        // A block that should have told, and one that does not, disagree.
        assert!(!is_better(&with(&[[30.0, 31.0], [-9.0, 10.5]])));
        assert!(!is_better(&with(&[])));
        assert!(!is_better(&[[0.0, 0.0]; 5]) && !is_better(&[]));
    }
}
