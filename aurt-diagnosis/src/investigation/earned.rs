//! What was selected, put to the test before it is said.
//!
//! Selection asks what describes the recordings best. What it takes may still have parameters that no machine has, or be
//! within chance of nothing, in the rows that it was selected on or in those that nothing was fitted to. What fails one
//! of these tests is an indication: it leaves the model, and is listed apart with what it fails.

use crate::contact::force_columns;
use crate::error::DiagnosisError;
use crate::evidence::account::has_structure;
use crate::evidence::baseline::weighted_fit;
use crate::evidence::between::{DRY, Share};
use crate::evidence::deviations::beyond_chance;
use crate::evidence::gram::dot;
use crate::evidence::linear::Cholesky;
use crate::evidence::residuals::shares;
use crate::hypotheses::group::{Group, Switch};
use crate::investigation::Investigation;
use crate::investigation::common::is_in_all;
use crate::investigation::fitted::Fitted;
use crate::parameters::Parameters;
use crate::recordings::rows::mean_rate_hz;
use crate::request::Question;
use crate::search::selection::Chosen;

/// What was selected and fails a test.
#[derive(Debug, Clone)]
pub struct Indicated {
    /// What was selected.
    pub chosen: Chosen,
    /// Which tests it fails, in words.
    pub fails: Vec<String>,
    /// True if more than half of the pieces of the confirming rows are for it, though too few, and nothing else is against it.
    pub lacks_confirmation: bool,
    /// True for a change that is within what recordings of an unchanged robot differ by.
    pub usual: bool,
}

/// Coefficients of nothing are as far from zero with this probability; `p_null` is what the search adds to chance.
const BY_CHANCE: f64 = 0.01;

/// A whole-arm effect concerns joints that lose at least this share of the largest loss.
const CONCERNED: f64 = 0.08;

/// The joints whose error a whole-arm effect explains.
pub(crate) fn concerned(chosen: &Chosen) -> Vec<usize> {
    let largest = chosen.joint_loss.iter().copied().fold(0.0, f64::max);
    (0..chosen.joint_loss.len()).filter(|j| chosen.joint_loss[*j] > CONCERNED * largest).collect()
}

/// Takes what fails out of the selection, one after another, and tests what remains anew: first what chance makes most easily, since
/// beside what fits some recordings only, held-out rows speak against what is there as well; then the weakest. Notes for the rest
/// why it is not claimed though it stays in the model, lest something else takes its place.
pub(crate) fn earn(question: &Question<'_>, investigation: &mut Investigation) -> Result<(), DiagnosisError> {
    if investigation.selection.chosen.is_empty() {
        return Ok(());
    }
    let reach_m = reach_m(question, investigation)?;
    let mut indicated = Vec::new();
    loop {
        let trial = Trial::new(question, investigation, reach_m);
        let most = trial.largest_by_chance(question.selection.level);
        let mut fails = trial.all_fails(most);
        let Some(worst) = trial.worst(&fails, most) else {
            let withheld: Vec<Option<String>> = (0..fails.len()).map(|i| trial.withheld(i)).collect();
            for (chosen, why) in investigation.selection.chosen.iter_mut().zip(withheld) {
                chosen.withheld = why;
            }
            break;
        };
        let usual = trial.usual(worst).is_some();
        drop(trial);
        let chosen = investigation.selection.chosen.remove(worst);
        let fails = fails.swap_remove(worst);
        let is_rare = chosen.p_null.is_none_or(|p| p <= question.selection.level);
        let lacks_confirmation =
            fails.len() == 1 && is_rare && chosen.p_confirm.is_some_and(|p| p > most && p <= 0.5);
        indicated.push(Indicated { chosen, fails, lacks_confirmation, usual });
        investigation.confirm_chosen(question);
    }
    indicated.sort_by(|a, b| b.chosen.score.total_cmp(&a.chosen.score));
    investigation.indicated = indicated;
    Ok(())
}

/// The largest probability of a claim, of which chance alone makes at most a share on average: the largest p(k) ≤ k · share
/// / m of m ascending ones (Y. Benjamini, Y. Hochberg, *J. Royal Statistical Society B* 57, 1995).
fn largest_of_claims(by_chance: &[Option<f64>], share: f64) -> f64 {
    let mut ascending: Vec<f64> = by_chance.iter().copied().flatten().collect();
    ascending.sort_by(f64::total_cmp);
    let m = ascending.len() as f64;
    let within = ascending.iter().zip(1_u32..).filter(|(p, k)| **p <= f64::from(*k) * share / m);
    within.map(|(p, _)| *p).fold(0.0, f64::max)
}

/// The longest lever of a force on any link about any joint, over the fitted rows, m.
fn reach_m(question: &Question<'_>, investigation: &Investigation) -> Result<f64, DiagnosisError> {
    let body = question.model.rigid_body();
    let mut longest: f64 = 0.0;
    for rows in investigation.rows.iter().filter(|r| r.rows() > 0) {
        for link in force_columns(&**body, rows)? {
            longest = link.axes.iter().flatten().flatten().fold(longest, |most, lever| most.max(lever.abs()));
        }
    }
    Ok(longest)
}

/// What was selected, as it is fitted, and what each of it brings.
struct Trial<'a> {
    investigation: &'a Investigation,
    groups: Vec<&'a Group>,
    joints: Vec<Vec<usize>>,
    parameters: Vec<Parameters>,
    reach_m: f64,
    /// The log-MSE that it must bring on one of its joints, joint by joint.
    least: Vec<f64>,
    /// Mean squares of an unchanged arm in the targets' motion, joint by joint.
    unchanged: Vec<f64>,
    /// Squares beyond these that are left of the targets, in their units, of joints that keep structure there.
    new: Vec<f64>,
    /// Share by which an effect lowers the squared error at least.
    reduction: f64,
    whole: Fitted,
    /// Level of the tests of changes.
    level: f64,
    /// Sums of squares over fitted rows, `[kind][joint]`: with all, and without one of it.
    errors: [Vec<f64>; 2],
    errors_without: Vec<[Vec<f64>; 2]>,
}

/// The torque that something is named for.
struct Size {
    /// Its coefficients.
    named: Vec<Switch>,
    /// Their weights.
    weights: Vec<f64>,
    /// These among all coefficients.
    direction: Vec<f64>,
    freedoms: f64,
    size: f64,
}

impl<'a> Trial<'a> {
    fn new(question: &Question<'_>, investigation: &'a Investigation, reach_m: f64) -> Self {
        let chosen = &investigation.selection.chosen;
        let groups: Vec<&Group> = chosen.iter().map(|c| &investigation.groups[c.group]).collect();
        let of = |groups: &[&Group]| investigation.switches_of(groups.iter().copied());
        let whole = Fitted::new(investigation, of(&groups));
        let (fit, floor) = (&whole.fit, &investigation.floor);
        let Investigation { rows, partition, layout, .. } = investigation;
        let shares = shares(rows, partition, layout, &whole.switches, &fit.coefficients);
        let rate_hz = mean_rate_hz(rows);
        let without = |i: usize| {
            let rest: Vec<&Group> =
                groups.iter().enumerate().filter(|(k, _)| *k != i).map(|(_, g)| *g).collect();
            weighted_fit(&investigation.problem, &of(&rest), floor).0.squared_errors
        };
        let unchanged = investigation.usual_errors(&whole.switches, fit);
        let left = investigation.left_in_targets(&whole, &whole.switches, fit, &unchanged);
        let new = left.iter().zip(&unchanged).enumerate().map(|(j, (left, usual))| {
            let rows = investigation.problem.total()[1][j].rows;
            if has_structure(*left, *usual) { rows * (left / usual - 1.0) } else { 0.0 }
        });
        let new = new.collect();
        let errors_without = (0..groups.len()).map(without).collect();
        let own = whole.own(&investigation.baseline.coefficients, &investigation.base_switches);
        let parameters = groups
            .iter()
            .map(|g| whole.parameters(g, &investigation.candidates[g.candidate], question.model, &own))
            .collect();
        let joints = groups.iter().zip(chosen).map(|(group, one)| {
            if group.effect.is_whole_arm { concerned(one) } else { group.joints.clone() }
        });
        Self {
            joints: joints.collect(),
            errors: fit.squared_errors.clone(),
            errors_without,
            least: shares.iter().map(|s| question.selection.least_log_error(s * rate_hz)).collect(),
            new,
            unchanged,
            reduction: question.selection.reduction,
            investigation,
            groups,
            parameters,
            reach_m,
            level: question.selection.level,
            whole,
        }
    }

    /// The tests that each of it fails.
    fn all_fails(&self, most: f64) -> Vec<Vec<String>> {
        let mut fails: Vec<Vec<String>> = (0..self.groups.len()).map(|i| self.fails(i)).collect();
        for (i, fails) in fails.iter_mut().enumerate() {
            if let Some(p) = self.by_chance(i).filter(|p| *p > most) {
                let is_of_search = self.investigation.selection.chosen[i].p_null == Some(p);
                let by =
                    if is_of_search { "makes such a finding" } else { "lowers the held-out errors as much" };
                fails.push(format!("chance alone {by} with a probability of {p:.2}, too large for its rank"));
            }
        }
        fails
    }

    /// The largest probability by chance that passes.
    fn largest_by_chance(&self, level: f64) -> f64 {
        let by_chance: Vec<Option<f64>> = (0..self.groups.len()).map(|i| self.by_chance(i)).collect();
        largest_of_claims(&by_chance, level)
    }

    /// The probability that chance alone makes one of it.
    fn by_chance(&self, i: usize) -> Option<f64> {
        self.investigation.selection.chosen[i].by_chance()
    }

    /// The one of those that fail which leaves the selection first.
    fn worst(&self, fails: &[Vec<String>], most: f64) -> Option<usize> {
        let chance = |i: usize| self.by_chance(i).filter(|p| *p > most).unwrap_or(0.0);
        let score = |i: usize| self.investigation.selection.chosen[i].score;
        let order =
            |a: &usize, b: &usize| chance(*a).total_cmp(&chance(*b)).then(score(*b).total_cmp(&score(*a)));
        (0..fails.len()).filter(|i| !fails[*i].is_empty()).max_by(order)
    }

    /// The tests that one of it fails by itself.
    fn fails(&self, i: usize) -> Vec<String> {
        let group = self.groups[i];
        let mut fails: Vec<String> =
            group.effect.impossible(&self.parameters[i], self.reach_m).into_iter().collect();
        fails.extend(self.too_near_zero(i));
        fails.extend(self.part_of_more(i));
        if fails.is_empty() {
            fails.extend(is_in_all(self.investigation, group, self.level));
        }
        let kinds: &[usize] = if group.target_only() { &[1] } else { &[0, 1] };
        if !self.lowers_error(i, kinds) {
            let least = self.joints[i].iter().map(|j| self.least[*j]).fold(f64::INFINITY, f64::min);
            fails.push(format!(
                "it reduces the squared error of no joint by {:.0} % beyond the other selected effects",
                100.0 * (1.0 - (-least).exp())
            ));
        }
        fails
    }

    /// Says that the targets keep so much that is new on the joints of a change (on all, of one of the whole arm) that it may be the part
    /// of something else which its law can imitate: as much beside what it explains as makes an effect.
    fn part_of_more(&self, i: usize) -> Option<String> {
        if !self.groups[i].target_only() || !self.investigation.problem.has_reference() {
            return None;
        }
        let counts = |j: &usize| self.groups[i].effect.is_whole_arm || self.joints[i].contains(j);
        let [mut explained, mut new] = [0.0; 2];
        for j in (0..self.new.len()).filter(counts).filter(|j| self.unchanged[*j].is_normal()) {
            explained += (self.errors_without[i][1][j] - self.errors[1][j]) / self.unchanged[j];
            new += self.new[j];
        }
        let all = f64::max(explained, 0.0) + new;
        (new > self.reduction * all).then(|| {
            let [share, least] = [1.0 - new / all, 1.0 - self.reduction].map(|share| (100.0 * share).floor());
            format!("it explains {share:.0} % of what is new in the targets beside the other effects, not {least:.0} %")
        })
    }

    /// True if it lowers the squared error of one of its joints by what it must, in some kinds of recordings.
    fn lowers_error(&self, i: usize, kinds: &[usize]) -> bool {
        let sum = |errors: &[Vec<f64>; 2], j: usize| kinds.iter().map(|k| errors[*k][j]).sum::<f64>();
        self.joints[i].iter().any(|j| {
            let (with, without) = (sum(&self.errors, *j), sum(&self.errors_without[i], *j));
            with < (-self.least[*j]).exp() * without
        })
    }

    /// True if the recordings beside the targets, by themselves, have one of its joints explained by as much: what the targets keep bends a
    /// fit to both.
    fn lowers_reference(&self, i: usize) -> bool {
        let (problem, Fitted { switches, weights, .. }) = (&self.investigation.problem, &self.whole);
        let own = &self.groups[i].switches;
        let rest: Vec<Switch> = switches.iter().filter(|s| !own.contains(s)).copied().collect();
        let [with, without] = [switches, &rest].map(|s| problem.reference_errors(s, weights));
        self.joints[i].iter().any(|j| with[*j] < (-self.least[*j]).exp() * without[*j])
    }

    /// The coefficients that one of it is named for: the direction g that was fitted (or the effect's contrast) among all, the number of
    /// freedoms, and the size gᵀβ.
    fn size(&self, i: usize) -> Size {
        let (group, whole, problem) = (self.groups[i], &self.whole, &self.investigation.problem);
        let named: Vec<Switch> =
            group.switches.iter().filter(|s| !group.accessory.contains(s)).copied().collect();
        let places: Vec<Option<usize>> = named.iter().map(|s| whole.place(s.column, s.target_only)).collect();
        let contrast = group.effect.contrast;
        let (weights, d) = if contrast.len() == named.len() {
            (contrast.to_vec(), 1.0)
        } else {
            let values: Vec<f64> =
                places.iter().map(|at| at.map_or(0.0, |at| whole.fit.coefficients[at])).collect();
            let gram = problem.cross(problem.total(), &named, &named, &whole.weights);
            let weights = gram.chunks_exact(named.len().max(1)).map(|products| dot(products, &values));
            (weights.collect(), places.iter().flatten().count().max(1) as f64)
        };
        let mut direction = vec![0.0; whole.switches.len()];
        for (weight, at) in weights.iter().zip(&places) {
            at.iter().for_each(|at| direction[*at] = *weight);
        }
        let size = dot(&direction, &whole.fit.coefficients).abs();
        Size { named, weights, direction, freedoms: d, size }
    }

    /// Says that the torque that it is named for may be none. gᵀβ has the larger of the deviation that residuals with a memory give and of
    /// the jackknife's over blocks, of which there are so many that their ratio is Student's t where nothing is.
    fn too_near_zero(&self, i: usize) -> Option<String> {
        let Size { direction, size, .. } = self.size(i);
        let blocks = self.investigation.problem.blocks();
        let sure = beyond_chance(1.0, blocks as f64 - 1.0, BY_CHANCE);
        let from_zero = size / self.deviation(&direction, 1.0);
        (from_zero < sure)
            .then(|| format!("it is {from_zero:.1} σ from zero; {blocks} blocks of time require {sure:.1} σ"))
    }

    fn deviation(&self, direction: &[f64], factor: f64) -> f64 {
        self.whole.deviation(&self.investigation.problem, direction, factor).max(f64::MIN_POSITIVE)
    }

    /// Says why one of it is not claimed though the recordings show it.
    fn withheld(&self, i: usize) -> Option<String> {
        let Investigation { problem, undetermined, .. } = self.investigation;
        if self.groups[i].target_only() {
            return self.usual(i);
        }
        let has_both = problem.has_reference() && problem.has_target() && !undetermined;
        let shows = !self.groups[i].is_named() || self.lowers_reference(i);
        (has_both && !shows).then(|| "the calibration recordings do not show it".to_owned())
    }

    /// Says that a change is within what recordings of an unchanged robot differ by. Each joint could have shown one: the level is that of a
    /// search over all.
    ///
    /// With the variance that noise gives gᵀβ, and what recordings add to it, (gᵀβ)² over both and the number of coefficients is F, of
    /// Satterthwaite's degrees of freedom (*Biometrics Bulletin* 2, 1946). Calibration recordings tell what they add to it where there are
    /// some. Friction differs by a share of itself as well, which joints have in common and a single recording does not tell: then it is
    /// [`BETWEEN_RECORDINGS`]. A share makes the change I⁻¹CᵀWF with I = CᵀWC, the columns C of the change and those of friction F. The
    /// larger of both counts.
    fn usual(&self, i: usize) -> Option<String> {
        let (group, whole) = (self.groups[i], &self.whole);
        if !group.target_only() || !self.investigation.problem.has_reference() {
            return None;
        }
        let size = self.size(i);
        let searches = self.least.len() as f64 / group.joints.len() as f64;
        let level = -libm::expm1(libm::log1p(-self.level) / searches);
        let noise = self.deviation(&size.direction, 1.0);
        let among = whole.inflation(group).map(|by| {
            let added = self.deviation(&size.direction, by.factor).powi(2) - noise * noise;
            (added, by.freedom, "calibration recordings differ by among themselves".to_owned())
        });
        let by_share = group.effect.is_friction.then(|| self.by_share(&size));
        let larger = among.into_iter().chain(by_share).max_by(|a, b| a.0.total_cmp(&b.0));
        let (added, freedom, what) = larger.filter(|(added, ..)| *added > 0.0)?;
        let square = noise * noise + added;
        let freedom = (freedom * (square / added).powi(2)).min(Share::USUAL.freedom);
        let [sure, from_zero] = [beyond_chance(size.freedoms, freedom, level), size.size / square.sqrt()];
        (from_zero < sure)
            .then(|| format!("it is {from_zero:.1} σ from zero beside what {what}; {sure:.1} σ are required"))
    }

    /// The variance that friction which differs by a share of itself gives a change, its degrees of freedom, and words for it.
    fn by_share(&self, size: &Size) -> (f64, f64, String) {
        let share = self.whole.between.unwrap_or(Share::USUAL);
        let by = match self.whole.between {
            Some(_) => "among calibration recordings",
            None => "that of other robots: one calibration recording does not tell",
        };
        let [dry, other] = [DRY, 1.0].map(|of| 100.0 * of * share.std);
        let what = format!(
            "friction differs by from one recording to the next ({dry:.1} % if dry and {other:.1} % if not, {by})"
        );
        (self.by_friction(size, share), share.freedom, what)
    }

    /// Variance of the size of a change where the coefficients of friction differ by a share of themselves.
    fn by_friction(&self, Size { named, weights, .. }: &Size, share: Share) -> f64 {
        let Investigation { problem, model, baseline, base_switches, .. } = self.investigation;
        let own = self.whole.own(&baseline.coefficients, base_switches);
        let (columns, deviations): (Vec<Switch>, Vec<f64>) =
            share.changes(model, &own).into_iter().flatten().unzip();
        let (total, beside) = (problem.total(), &self.whole.weights);
        let gram = problem.cross(total, named, named, beside);
        let weights = Cholesky::new(&gram, named.len()).solve(weights);
        let products = problem.cross(total, named, &columns, beside);
        let changes = products.chunks_exact(named.len().max(1)).zip(deviations);
        changes.map(|(product, deviation)| (deviation * dot(product, &weights)).powi(2)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::largest_of_claims;

    #[test]
    fn what_chance_makes_is_a_share_of_all_claims() {
        let most = |p: &[f64]| largest_of_claims(&p.iter().copied().map(Some).collect::<Vec<_>>(), 0.05);
        assert_eq!(most(&[0.04]), 0.04);
        assert_eq!(most(&[0.9, 0.001, 0.04, 0.7]), 0.001);
        assert_eq!(most(&[0.001, 0.001, 0.03, 0.7]), 0.03);
        assert_eq!(most(&[0.2, 0.3]), 0.0);
        assert_eq!(largest_of_claims(&[None], 0.05), 0.0);
    }
}
