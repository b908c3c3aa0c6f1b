//! What the model leaves with and without what was found, for each of the two questions.

use crate::evidence::account::{Left, STRUCTURE};
use crate::evidence::baseline::weighted_fit;
use crate::evidence::deviations::Resampled;
use crate::evidence::residuals::residuals;
use crate::evidence::total::TotalFit;
use crate::hypotheses::group::{Group, Switch};
use crate::investigation::Investigation;

/// Fewer rows that confirm say nothing of a joint.
const FEWEST_CONFIRMING: f64 = 20.0;

/// Share of its error by which a joint's may change while nothing that was found is about it: terms of other joints move the
/// base parameters that they share.
const UNTOUCHED: f64 = 0.05;

/// Errors of one question, joint by joint.
#[derive(Debug, Clone)]
pub(crate) struct OfQuestion {
    /// Over the rows that fit.
    pub(crate) fitted: Vec<Left>,
    /// Over held-out rows.
    pub(crate) confirmed: Vec<Left>,
}

/// Errors of both questions.
#[derive(Debug, Clone)]
pub(crate) struct Errors {
    /// What has changed in the targets, where recordings stand beside them.
    pub(crate) change: Option<OfQuestion>,
    /// What is missing: in the recordings beside the targets, or in all there are.
    pub(crate) structure: OfQuestion,
}

/// A fit, with the coefficients that it has.
struct Model {
    switches: Vec<Switch>,
    fit: TotalFit,
}

impl Errors {
    /// Of an investigation. Registered models have no names and account for nothing; joints of `apart` are left out: what
    /// was found of them is no part of the model. The noise of each joint is `louder` times its floor.
    pub(crate) fn new(
        investigation: &Investigation,
        has_targets: bool,
        apart: &[usize],
        louder: &[f64],
    ) -> Self {
        let chosen = investigation.selection.chosen.iter().map(|c| &investigation.groups[c.group]);
        let named: Vec<&Group> = chosen.filter(|g| g.is_named()).collect();
        let model = |of: &dyn Fn(&Group) -> bool| {
            let switches = investigation.switches_of(named.iter().copied().filter(|g| of(g)));
            let fit = weighted_fit(&investigation.problem, &switches, &investigation.floor).0;
            Model { switches, fit }
        };
        let whole = model(&|_| true);
        let of = Of { investigation, apart };
        let noise = || -> Vec<f64> {
            investigation.floor.iter().zip(louder).map(|(f, louder)| louder * f.sqrt()).collect()
        };
        if !(has_targets && investigation.problem.has_reference()) {
            let bare = model(&|_| false);
            let kind = usize::from(!investigation.problem.has_reference());
            let noise = noise();
            // As it was calibrated, where that was without the rows in question.
            let calibrated = Model {
                switches: investigation.base_switches.clone(),
                fit: TotalFit {
                    coefficients: investigation.baseline.coefficients.clone(),
                    ..bare.fit.clone()
                },
            };
            let structure = of.question([&bare, &calibrated, &whole], kind, &noise, louder);
            return Self { change: None, structure };
        }
        let unchanged = model(&|g| !g.target_only());
        let bare = model(&Group::target_only);
        let noise = noise();
        let usual: Vec<f64> = of.usual(&whole).into_iter().zip(&noise).map(|(u, n)| u.max(*n)).collect();
        Self {
            change: Some(of.question([&unchanged, &unchanged, &whole], 1, &usual, &vec![1.0; usual.len()])),
            structure: of.question([&bare, &bare, &whole], 0, &noise, louder),
        }
    }
}

struct Of<'a> {
    investigation: &'a Investigation,
    apart: &'a [usize],
}

impl Of<'_> {
    /// Errors of `[fitted before, confirmed before, after]` over the rows of a kind, against references, which are `louder`
    /// times what is seen of them.
    fn question(&self, models: [&Model; 3], kind: usize, references: &[f64], louder: &[f64]) -> OfQuestion {
        let [before, calibrated, after] = models;
        let asked = |j: &usize| !self.apart.contains(j);
        let joints = self.investigation.problem.joints();
        let fitted = (0..joints).filter(asked).filter(|j| self.rows(kind, *j) > 0.0).map(|j| Left {
            before: self.fitted_rms(before, kind, j),
            after: self.fitted_rms(after, kind, j),
            floor: references[j],
            seen: references[j] / louder[j],
        });
        let (was, is, counts) = self.confirmed(calibrated, after);
        let expected = self.expected(after, references);
        // A joint that the rows that fit show at its reference, and that nothing found touches, says nothing of what was found.
        let concerned = |j: &usize| {
            let excess =
                self.rows(kind, *j) > 0.0 && self.fitted_rms(before, kind, *j) > STRUCTURE * references[*j];
            excess || (is[*j] - was[*j]).abs() > UNTOUCHED * was[*j]
        };
        let judged = (0..joints).filter(asked).filter(|j| counts[*j] >= FEWEST_CONFIRMING).filter(concerned);
        let confirmed = judged.map(|j| {
            let floor = (expected[j] / counts[j]).sqrt();
            let rms = |squares: &[f64]| (squares[j] / counts[j]).sqrt();
            Left { before: rms(&was), after: rms(&is), floor, seen: floor / louder[j] }
        });
        OfQuestion { fitted: fitted.collect(), confirmed: confirmed.collect() }
    }

    fn rows(&self, kind: usize, joint: usize) -> f64 {
        self.investigation.problem.total()[kind][joint].rows
    }

    fn fitted_rms(&self, model: &Model, kind: usize, joint: usize) -> f64 {
        (model.fit.squared_errors[kind][joint] / self.rows(kind, joint).max(1.0)).sqrt()
    }

    /// What the whole model leaves of an unchanged arm in the targets' motion: what it leaves of the recordings beside
    /// them, as much larger as the torque is, and no less than noise. A wrong structure errs in proportion to the torque.
    fn usual(&self, whole: &Model) -> Vec<f64> {
        let total = self.investigation.problem.total();
        (0..self.investigation.problem.joints())
            .map(|j| {
                // What never moved beside the targets has nothing that it could have changed from.
                if self.rows(0, j) <= 0.0 {
                    return f64::INFINITY;
                }
                let power = |kind: usize| total[kind][j].square / total[kind][j].rows.max(1.0);
                // What a given model leaves is no measure of the torque.
                let louder = if self.investigation.baseline.frozen || power(0) <= 0.0 {
                    1.0
                } else {
                    (power(1) / power(0)).sqrt().max(1.0)
                };
                let left = self.fitted_rms(whole, 0, j).min(self.calibrated_rms(j));
                (louder * left).max(self.investigation.floor[j].sqrt())
            })
            .collect()
    }

    /// What the model calibrated without the targets leaves of the recordings beside them, with the degrees of freedom that
    /// the fit takes given back: a fit to both spreads a change over both. Infinite for a given model, and where there are
    /// too few independent rows to tell.
    fn calibrated_rms(&self, joint: usize) -> f64 {
        let Investigation { problem, base_switches, baseline, mean_independent_share, .. } =
            self.investigation;
        let independent = mean_independent_share * self.rows(0, joint);
        let freedoms = base_switches.len() as f64 / problem.joints() as f64;
        if baseline.frozen || self.investigation.undetermined || independent <= freedoms {
            return f64::INFINITY;
        }
        let errors = problem.squared_errors(problem.total(), base_switches, &baseline.coefficients);
        let given_back = independent / (independent - freedoms);
        (errors[0][joint] / self.rows(0, joint).max(1.0) * given_back).sqrt()
    }

    /// Sums of squares that a model without a fault leaves of the held-out rows: the noise of those recordings
    /// (no less than the reference of the rows that fit), and the variance of its prediction, since its coefficients are
    /// known no better than the rows that fit tell. The variance is the jackknife's over blocks of time, which sees the
    /// memory and the misfit of the residual: (B − 1)/B Σ_b (w·β_b − w·β̄)², w a row.
    fn expected(&self, model: &Model, references: &[f64]) -> Vec<f64> {
        let Investigation { problem, floor, layout, floors, confirm, .. } = self.investigation;
        let weights = weighted_fit(problem, &model.switches, floor).1;
        let resampled = Resampled::new(problem, &model.switches, &weights);
        let mut sums = vec![0.0; problem.joints()];
        for (r, rows) in confirm.to_judge().iter().enumerate().filter(|(_, rows)| rows.rows() > 0) {
            let variance = resampled.variance(|c| residuals(rows, layout, &model.switches, c));
            for (j, sum) in sums.iter_mut().enumerate() {
                let noise = floors[r][j].max(references[j].powi(2));
                *sum += noise * rows.joints[j].counted(0, rows.rows()) + variance[j];
            }
        }
        sums
    }

    /// Sums of squares over the held-out rows, before and after, and how many there are of each joint.
    fn confirmed(&self, before: &Model, after: &Model) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let joints = self.investigation.problem.joints();
        let (mut was, mut is, mut counts) = (vec![0.0; joints], vec![0.0; joints], vec![0.0; joints]);
        let layout = &self.investigation.layout;
        for rows in self.investigation.confirm.to_judge().iter().filter(|r| r.rows() > 0) {
            for (sums, model) in [(&mut was, before), (&mut is, after)] {
                let left = residuals(rows, layout, &model.switches, &model.fit.coefficients);
                for (sum, series) in sums.iter_mut().zip(&left) {
                    *sum += series.iter().map(|v| v * v).sum::<f64>();
                }
            }
            for (count, joint) in counts.iter_mut().zip(&rows.joints) {
                *count += joint.counted(0, rows.rows());
            }
        }
        (was, is, counts)
    }
}
