use serde_json::Value;

use super::doubt::{Contest, DeviationGoal, Explanation, ModelFit, Subject};
use super::motion::{MotionMoments, add};
use super::{Discrimination, claimed, decided};
use crate::evidence::gram::{Moments, dot};
use crate::evidence::linear::Cholesky;
use crate::hypotheses::group::Switch;
use crate::verdict::reported;
use crate::vocabulary::OwnFriction;

/// What a motion would do about a doubt.
#[derive(Debug, Clone)]
pub struct Outlook {
    /// Expected logarithm of the ratio of likelihoods of two rivals, the smaller of what it is if the one or the other is true;
    /// none for other doubts.
    pub nats: Option<f64>,
    /// The probability that the doubt is settled: that the true one of two rivals is preferred, that an effect is claimed if it
    /// is there, that an absorbed one is, over sizes of its torque; of a parameter, the share of the wanted deviation.
    pub settled: f64,
    /// The probability that the wrong explanation is preferred.
    pub wrongly: f64,
    /// The evidence of the motion: the expected logarithm of the ratio of likelihoods, or the square of the ratio of the wanted
    /// deviation to that which is left. Other than a probability it still grows where the doubt is all but settled.
    pub evidence: f64,
    /// Share of the torque that the other explanation, or the model, cannot take up; of positions its root mean square in units of
    /// what a model is expected to miss.
    pub free: f64,
    /// The parameter in question, now and after the motion.
    pub interval: Option<Interval>,
}

/// A parameter's standard deviation (the largest, of a list).
#[derive(Debug, Clone, PartialEq)]
pub struct Interval {
    /// Name of the parameter.
    pub parameter: String,
    /// The parameter.
    pub value: Value,
    /// Its deviation now.
    pub now: f64,
    /// Its deviation with the motion recorded.
    pub after: f64,
}

impl Outlook {
    /// The outlook of a parameter whose deviation is to be the wanted one.
    pub(super) fn of_width(interval: Option<Interval>, wanted: f64) -> Self {
        let ratio = interval.as_ref().map_or(0.0, |i| wanted / i.after);
        let (settled, evidence) = (ratio.min(1.0), ratio * ratio);
        Self { nats: None, settled, wrongly: 0.0, evidence, free: 1.0, interval }
    }
}

impl Discrimination<'_> {
    pub(super) fn of_rivals(&self, [one, other]: &[Explanation; 2], planned: &MotionMoments) -> Outlook {
        let problem = &self.investigation.problem;
        let ways = [(one, other), (other, one)].map(|(truth, rival)| {
            self.apart(&truth.truth, &rival.rival, &planned.moments, Some(problem.total()))
        });
        let nats = ways[0].nats.min(ways[1].nats);
        let [settled, wrongly] = decided(nats, problem.blocks());
        let free = ways[0].free.min(ways[1].free);
        Outlook { nats: Some(nats), settled, wrongly, evidence: nats, free, interval: None }
    }

    pub(super) fn of_indicated(
        &self,
        [with, without]: &[Explanation; 2],
        all: &[Vec<Moments>; 2],
    ) -> Outlook {
        let Apart { nats, free } = self.apart(&with.truth, &without.rival, all, None);
        let [settled, wrongly] = self.claimed(nats);
        Outlook { nats: None, settled, wrongly, evidence: nats, free, interval: None }
    }

    pub(super) fn of_wide(
        &self,
        subject: &Subject,
        wanted: &DeviationGoal,
        all: &[Vec<Moments>; 2],
    ) -> Outlook {
        let of_subject = self.intervals_of(subject, &self.narrowed(all));
        let interval = of_subject.into_iter().find(|i| i.parameter == wanted.parameter);
        Outlook::of_width(interval, wanted.std)
    }

    /// The outlook of an effect that the present recordings absorb, if all together leave shares of its torque free.
    pub(super) fn of_absorbed(
        &self,
        subject: &Subject,
        free: FreeShares,
        all: &[Vec<Moments>; 2],
    ) -> Outlook {
        let rows = |j: &usize| all.iter().map(|kind| kind[*j].rows).sum::<f64>();
        let independent = self.share * subject.joints.iter().map(rows).fold(0.0, f64::max);
        let nats = 0.5 * independent * free.of_model.min(free.of_rival).powi(2);
        let settled = self.found(independent, free);
        Outlook { nats: None, settled, wrongly: 0.0, evidence: nats, free: free.of_model, interval: None }
    }

    /// The probability that an effect of unknown size is claimed and preferred to its rivals. It has to lower the mean square by the
    /// share r² that a claim requires. All ratios of its torque to the noise are taken to be as probable between r, with which it is
    /// claimed if no part of it is absorbed, and r over the least share that is examined, with which it always is.
    fn found(&self, independent: f64, free: FreeShares) -> f64 {
        let least_share = self.question.selection.free_share;
        let widest = (free.of_model / least_share).ln();
        if widest <= 0.0 {
            return 0.0;
        }
        let blocks = self.investigation.problem.blocks();
        let rival = (free.of_rival / free.of_model).powi(2);
        let at = |k: usize| {
            let part = (k as f64 + 0.5) / SIZES as f64;
            let nats = 0.5 * independent * self.reduction * (2.0 * part * widest).exp();
            self.claimed(nats)[0].min(decided(nats * rival, blocks)[0])
        };
        (0..SIZES).map(at).sum::<f64>() / SIZES as f64 * widest / -least_share.ln()
    }

    /// The probability that a diagnosis claims an effect that is there, and that it claims one that is not.
    fn claimed(&self, nats: f64) -> [f64; 2] {
        claimed(nats, self.investigation.problem.blocks(), self.question.selection.score)
    }

    /// The distance of the rival's torque from that of the truth over some moments, with the coefficients that bring it nearest. Present
    /// recordings that are not among the moments hold these coefficients.
    fn apart(
        &self,
        truth: &ModelFit,
        rival: &ModelFit,
        moments: &[Vec<Moments>; 2],
        present: Option<&[Vec<Moments>; 2]>,
    ) -> Apart {
        let problem = &self.investigation.problem;
        let (a, b, w) = (&truth.switches[..], &rival.switches[..], &self.weights[..]);
        let own: Vec<Switch> = a.iter().filter(|s| !b.contains(s)).copied().collect();
        let size = {
            let values: Vec<f64> =
                a.iter().zip(&truth.coefficients).filter(|(s, _)| !b.contains(s)).map(|(_, v)| *v).collect();
            problem.quadratic(moments, &own, &values, w)
        };
        let products = problem.cross(moments, b, a, w);
        let gram = problem.cross(moments, b, b, w);
        let (n, of_truth, of_rival) = (b.len(), &truth.coefficients, &rival.coefficients);
        let gradient: Vec<f64> = (0..n)
            .map(|k| {
                let of_a: f64 = of_truth.iter().enumerate().map(|(i, v)| products[i * n + k] * v).sum();
                of_a - dot(&gram[k * n..(k + 1) * n], of_rival)
            })
            .collect();
        // ‖X_A β_A − X_B β_B‖², in columns that both have once.
        let mut difference: Vec<(Switch, f64)> = a.iter().copied().zip(of_truth.iter().copied()).collect();
        for (switch, value) in b.iter().zip(of_rival) {
            match difference.iter_mut().find(|(known, _)| known == switch) {
                Some((_, known)) => *known -= value,
                None => difference.push((*switch, -value)),
            }
        }
        let (switches, values): (Vec<Switch>, Vec<f64>) = difference.into_iter().unzip();
        let far = problem.quadratic(moments, &switches, &values, w);
        let mut information = gram;
        if let Some(present) = present {
            let known = problem.cross(present, b, b, w);
            information.iter_mut().zip(known).for_each(|(sum, known)| *sum += known);
        }
        let near = dot(&gradient, &Cholesky::new(&information, n).solve(&gradient));
        let left = (far - near).max(0.0);
        Apart { nats: 0.5 * left, free: if size > 0.0 { (left / size).sqrt().min(1.0) } else { 1.0 } }
    }

    /// Shares of the torques of the absorbed ones among doubts that are free in the present recordings and the motion together.
    pub(super) fn free(&self, doubts: &[usize], all: &[Vec<Moments>; 2]) -> Vec<FreeShares> {
        let problem = &self.investigation.problem;
        let model = &self.fitted.switches[..];
        let (n, weights) = (model.len(), &self.base_weights[..]);
        let cholesky = Cholesky::new(&problem.cross(all, model, model, weights), n);
        // What the model leaves of each column, once.
        let mut columns: Vec<Switch> = Vec::new();
        let mut place = |switch: &Switch| {
            columns.iter().position(|known| known == switch).unwrap_or_else(|| {
                columns.push(*switch);
                columns.len() - 1
            })
        };
        let mut places = |law: &[Switch]| law.iter().map(&mut place).collect::<Vec<usize>>();
        let mut laws: Vec<(Vec<usize>, Vec<Vec<usize>>)> = Vec::new();
        for doubt in doubts {
            if let Contest::Absorbed(subject, rivals) = &self.contests[*doubt] {
                laws.push((places(&subject.switches), rivals.iter().map(|rival| places(rival)).collect()));
            }
        }
        let mut projected = problem.cross(all, model, &columns, weights);
        projected.chunks_exact_mut(n.max(1)).for_each(|column| cholesky.forward(column));
        let own = problem.cross(all, &columns, &columns, weights);
        let of_model = |k: usize| &projected[k * n..(k + 1) * n];
        let left = |a: usize, b: usize| own[a * columns.len() + b] - dot(of_model(a), of_model(b));
        let lengths: Vec<f64> = own.iter().step_by(columns.len() + 1).copied().collect();
        laws.iter().map(|(law, rivals)| FreeShares::new(&left, &lengths, law, rivals)).collect()
    }

    /// The deviations of all coefficients with the motion recorded: those of now, less by what the motion adds to the
    /// information.
    pub(super) fn narrowed(&self, all: &[Vec<Moments>; 2]) -> Vec<f64> {
        let fitted = &self.fitted;
        let problem = &self.investigation.problem;
        let switches = &fitted.switches;
        let [now, then] = [problem.total(), all].map(|moments| {
            variances(&problem.cross(moments, switches, switches, &self.weights), switches.len())
        });
        let ratio = |k: usize| if now[k].is_finite() { (then[k] / now[k]).sqrt() } else { 1.0 };
        fitted.deviations.iter().enumerate().map(|(k, std)| std * ratio(k)).collect()
    }

    pub(super) fn intervals_of(&self, subject: &Subject, after: &[f64]) -> Vec<Interval> {
        let fitted = &self.fitted;
        let candidate = &self.investigation.candidates[subject.candidate];
        let target_only = subject.switches.first().is_some_and(|s| s.target_only);
        let own = fitted.own(&self.investigation.baseline.coefficients, &self.investigation.base_switches);
        let own = OwnFriction::of(self.question.model, candidate.proposal.joints[0], &own);
        let columns = fitted.columns(candidate, target_only);
        let narrowed = columns.iter().zip(&candidate.columns).map(|((name, value, std), column)| {
            let std = fitted.place(*column, target_only).map_or(*std, |k| after[k]);
            (name.clone(), *value, std)
        });
        let narrowed: Vec<_> = narrowed.collect();
        let [now, then] = [&columns, &narrowed].map(|columns| {
            reported(candidate.effect, candidate.effect.estimated(&candidate.proposal, columns, &own))
        });
        let interval = |(name, now): (String, crate::ParameterValue)| {
            let then = then.get(&name)?;
            let [was, will] = [&now.std, &then.std].map(largest);
            let (was, will) = (was?, will?);
            Some(Interval { parameter: name, value: now.value, now: was, after: will })
        };
        now.into_iter().filter_map(interval).collect()
    }
}

/// Shares of an effect's torque that are free.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct FreeShares {
    /// Beside the model.
    of_model: f64,
    /// Beside the model and the rival that takes most of it.
    of_rival: f64,
}

impl FreeShares {
    /// The shares of a law's columns, the most of them, from the inner products of what the model leaves of two columns and the squares
    /// of the columns themselves.
    fn new(
        left: &dyn Fn(usize, usize) -> f64,
        lengths: &[f64],
        law: &[usize],
        rivals: &[Vec<usize>],
    ) -> Self {
        let share = |k: usize, left: f64| {
            if lengths[k] > 0.0 { (left / lengths[k]).max(0.0).sqrt() } else { 0.0 }
        };
        let beside = |rival: &Vec<usize>| {
            let gram: Vec<f64> = rival.iter().flat_map(|a| rival.iter().map(|b| left(*a, *b))).collect();
            let cholesky = Cholesky::new(&gram, rival.len());
            let of_column = |k: &usize| {
                let mut taken: Vec<f64> = rival.iter().map(|a| left(*a, *k)).collect();
                cholesky.forward(&mut taken);
                share(*k, left(*k, *k) - dot(&taken, &taken))
            };
            law.iter().map(of_column).fold(0.0, f64::max)
        };
        let of_model = law.iter().map(|k| share(*k, left(*k, *k))).fold(0.0, f64::max);
        let of_rival = rivals.iter().map(beside).fold(of_model, f64::min);
        Self { of_model, of_rival }
    }
}

/// Sizes of an absorbed effect over which its probability is averaged: the mean of so many errs by 0.006 at most.
const SIZES: usize = 8;

/// The distance of two explanations.
struct Apart {
    nats: f64,
    free: f64,
}

/// Moments of the present recordings and of a motion.
pub(super) fn together(present: &[Vec<Moments>; 2], planned: &MotionMoments) -> [Vec<Moments>; 2] {
    let mut all = present.clone();
    add(&mut all, &planned.moments);
    all
}

/// Variances of the coefficients of normal equations; infinite where not excited.
fn variances(matrix: &[f64], n: usize) -> Vec<f64> {
    let cholesky = Cholesky::new(matrix, n);
    let of = |k: usize| {
        let mut unit = vec![0.0; n];
        unit[k] = 1.0;
        cholesky.forward(&mut unit);
        if cholesky.used()[k] { dot(&unit, &unit) } else { f64::INFINITY }
    };
    (0..n).map(of).collect()
}

/// The largest deviation of a parameter.
fn largest(std: &Value) -> Option<f64> {
    match std {
        Value::Array(list) => list.iter().filter_map(Value::as_f64).reduce(f64::max),
        one => one.as_f64(),
    }
}

#[cfg(test)]
mod tests {
    use super::FreeShares;

    #[test]
    fn a_torque_that_a_rival_takes_up_is_free_of_the_model_alone() {
        // Over four rows, of which the model takes none: the law, one that is like it in the first two, and one unlike it.
        let columns = [[1.0, 1.0, 1.0, 1.0], [1.0, 1.0, 0.0, 0.0], [1.0, -1.0, 1.0, -1.0]];
        let left = |a: usize, b: usize| (0..4).map(|k| columns[a][k] * columns[b][k]).sum();
        let of = |rivals: &[Vec<usize>]| FreeShares::new(&left, &[4.0, 2.0, 4.0], &[0], rivals);
        let beside = |rivals: &[Vec<usize>]| of(rivals).of_rival;
        assert!((beside(&[vec![2]]) - 1.0).abs() < 1e-12);
        // The rival that takes most decides.
        assert!((beside(&[vec![2], vec![1]]) - 0.5_f64.sqrt()).abs() < 1e-12);
        assert!(beside(&[vec![0]]) < 1e-6 && of(&[vec![0]]).of_model == 1.0);
    }
}
