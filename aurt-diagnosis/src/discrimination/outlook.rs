use serde_json::Value;

use super::doubt::{Doubt, ModelFit, Subject};
use super::motion::{MotionMoments, add};
use super::{Discrimination, decided};
use crate::evidence::gram::{Moments, dot};
use crate::evidence::linear::Cholesky;
use crate::hypotheses::group::Switch;
use crate::verdict::reported;
use crate::vocabulary::OwnFriction;

/// What a motion would do about a doubt.
#[derive(Debug, Clone)]
pub struct Outlook {
    /// Expected logarithm of the ratio of likelihoods, the smaller of what it is if the one or the other explanation is true;
    /// none for doubts without two explanations.
    pub nats: Option<f64>,
    /// The probability that the doubt is settled: that the true explanation is preferred; of a parameter, the share of the
    /// wanted deviation; of an absorbed effect, of the share of its torque that has to be free.
    pub settled: f64,
    /// The probability that the wrong explanation is preferred.
    pub wrongly: f64,
    /// The evidence that the motion brings: the expected logarithm of the ratio
    /// of likelihoods, the square of the free share, or of the ratio of the wanted deviation to that which is left. Other than
    /// a probability it still grows where the doubt is all but settled.
    pub evidence: f64,
    /// Share of the torque that the other explanation, or the model, cannot take up.
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

impl Discrimination<'_> {
    /// The outlook of every doubt, in the order of [`Discrimination::doubts`].
    #[must_use]
    pub fn outlook(&self, planned: &MotionMoments) -> Vec<Outlook> {
        self.doubts.iter().map(|doubt| self.of(doubt, planned)).collect()
    }

    /// The same of some doubts.
    #[must_use]
    pub fn outlook_of(&self, doubts: &[usize], planned: &MotionMoments) -> Vec<Outlook> {
        doubts.iter().map(|k| self.of(&self.doubts[*k], planned)).collect()
    }

    /// Deviations of all parameters of what is claimed, now and with a motion recorded.
    #[must_use]
    pub fn intervals(&self, planned: &MotionMoments) -> Vec<(Subject, Vec<Interval>)> {
        let after = self.narrowed(planned);
        let groups = self.investigation.selection.chosen.iter().map(|c| &self.investigation.groups[c.group]);
        groups
            .map(|group| {
                let subject = Subject::of(group);
                let intervals = self.intervals_of(&subject, &after);
                (subject, intervals)
            })
            .collect()
    }

    fn of(&self, doubt: &Doubt, planned: &MotionMoments) -> Outlook {
        match doubt {
            Doubt::Rivals { explanations, .. } | Doubt::Indicated { explanations, .. } => {
                let [one, other] = &**explanations;
                let ways = [
                    self.apart(&one.truth, &other.rival, planned),
                    self.apart(&other.truth, &one.rival, planned),
                ];
                let nats = ways[0].nats.min(ways[1].nats);
                let [settled, wrongly] = decided(nats, self.investigation.problem.blocks());
                let free = ways[0].free.min(ways[1].free);
                Outlook { nats: Some(nats), settled, wrongly, evidence: nats, free, interval: None }
            }
            Doubt::Absorbed { subject } => {
                let free = self.free(subject, planned);
                let settled = (free / self.question.selection.free_share).min(1.0);
                Outlook { nats: None, settled, wrongly: 0.0, evidence: free * free, free, interval: None }
            }
            Doubt::Wide { subject, wanted } => {
                let of_subject = self.intervals_of(subject, &self.narrowed(planned));
                let interval = of_subject.into_iter().find(|i| i.parameter == wanted.parameter);
                let ratio = interval.as_ref().map_or(0.0, |i| wanted.std / i.after);
                Outlook {
                    nats: None,
                    settled: ratio.min(1.0),
                    wrongly: 0.0,
                    evidence: ratio * ratio,
                    free: 1.0,
                    interval,
                }
            }
        }
    }

    /// How far the rival's torque stays from that of the truth, whatever coefficients it takes that the present recordings allow.
    fn apart(&self, truth: &ModelFit, rival: &ModelFit, planned: &MotionMoments) -> Apart {
        let problem = &self.investigation.problem;
        let (a, b, w) = (&truth.switches[..], &rival.switches[..], &self.weights[..]);
        let own: Vec<Switch> = a.iter().filter(|s| !b.contains(s)).copied().collect();
        let size = {
            let values: Vec<f64> =
                a.iter().zip(&truth.coefficients).filter(|(s, _)| !b.contains(s)).map(|(_, v)| *v).collect();
            problem.quadratic(&planned.moments, &own, &values, w)
        };
        let products = problem.cross(&planned.moments, b, a, w);
        let gram = problem.cross(&planned.moments, b, b, w);
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
        let far = problem.quadratic(&planned.moments, &switches, &values, w);
        let mut information = problem.cross(problem.total(), b, b, w);
        information.iter_mut().zip(&gram).for_each(|(sum, new)| *sum += new);
        let near = dot(&gradient, &Cholesky::new(&information, n).solve(&gradient));
        let left = (far - near).max(0.0);
        Apart { nats: 0.5 * left, free: if size > 0.0 { (left / size).sqrt().min(1.0) } else { 1.0 } }
    }

    /// Share of an absorbed effect's torque that is free in the present recordings and the motion together.
    fn free(&self, subject: &Subject, planned: &MotionMoments) -> f64 {
        let problem = &self.investigation.problem;
        let all = together(problem.total(), planned);
        let base = &self.investigation.base_switches;
        let share = problem.free_share_in(&all, base, &subject.switches, &self.base_weights);
        share.into_iter().fold(0.0, f64::max)
    }

    /// The deviations of all coefficients with the motion recorded: those of now, less by what the motion adds to the
    /// information.
    fn narrowed(&self, planned: &MotionMoments) -> Vec<f64> {
        let fitted = &self.fitted;
        let problem = &self.investigation.problem;
        let switches = &fitted.switches;
        let all = together(problem.total(), planned);
        let [now, then] = [problem.total(), &all].map(|moments| {
            variances(&problem.cross(moments, switches, switches, &self.weights), switches.len())
        });
        let ratio = |k: usize| if now[k].is_finite() { (then[k] / now[k]).sqrt() } else { 1.0 };
        fitted.deviations.iter().enumerate().map(|(k, std)| std * ratio(k)).collect()
    }

    fn intervals_of(&self, subject: &Subject, after: &[f64]) -> Vec<Interval> {
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
            reported(subject.effect, subject.effect.estimated(&candidate.proposal, columns, &own))
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

/// The distance of two explanations.
struct Apart {
    nats: f64,
    free: f64,
}

/// Moments of the present recordings and of a motion.
fn together(present: &[Vec<Moments>; 2], planned: &MotionMoments) -> [Vec<Moments>; 2] {
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
