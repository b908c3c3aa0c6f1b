//! Delays of the measurement, or of positions, scanned.

use aurt_traits::ColumnGroup;

use crate::evidence::baseline::weighted_fit;
use crate::evidence::total::free_first;
use crate::hypotheses::group::{Group, Switch};
use crate::investigation::Investigation;
use crate::investigation::agreement::agreement;
use crate::investigation::shifted::{confirming_errors, shift};
use crate::recordings::rows::{Instrument, mean_rate_hz};
use crate::request::Question;
use crate::vocabulary::Addition;

/// A delay of the measurement, or of positions where it is below zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Delay {
    /// By how much, s.
    pub delay_s: f64,
    /// Its standard deviation, s.
    pub std_s: f64,
    /// Evidence in nats.
    pub score: f64,
    /// True where only the target recordings are late.
    pub target_only: bool,
}

/// Steps of the scan per period of `f_dyn_hz`: V is a parabola over several of them.
const STEPS_PER_PERIOD: f64 = 40.0;

/// Steps of the scan to either side: up to a whole period.
const STEPS: i32 = 40;

/// Steps from one look for valleys to the next, an eighth of a period: the error 1 − cos 2πfd of a motion at f ≤ f_dyn reaches half its
/// height a quarter of a period from the lowest point, so that each valley is looked into four times.
const VALLEY: usize = 5;

/// Steps to either side of a joint's lowest error over which it is a parabola of the delay: after a tenth of a period 1 − cos 2πfd is
/// within 4 % of ½ (2πfd)².
const PARABOLIC: usize = 4;

/// Share of a step at which the lowest point is looked at once more, and how often at most.
const FINE: f64 = 0.25;
const CENTERINGS: usize = 4;

/// Turns after which the search of the lowest point ends, and the part of a step below which it has converged.
const MOST_TURNS: usize = 100;
const CONVERGED: f64 = 1e-9;

/// A delay within so many of its deviations of none is none.
const CLEAR: f64 = 3.0;

/// Share of a sampling period below which a delay is one of the stamps: clocks jitter by up to 6 % of it (world `rough`).
const LEAST_OF_SAMPLE: f64 = 0.1;

/// True for a delay among the hypotheses.
pub(super) fn is_delay(investigation: &Investigation, group: &Group) -> bool {
    matches!(
        investigation.candidates[group.candidate].proposal.addition,
        Addition::Instrument(_, Instrument::Delay | Instrument::DelayOfAll)
    )
}

/// Mean squared errors of the joints at a delay, a step before and a step after it.
struct Around<'a> {
    at_s: f64,
    step_s: f64,
    errors: [&'a [f64]; 3],
}

impl Around<'_> {
    /// The parabola through a joint's errors, c + s u + b u² with u in steps: c, s, b.
    fn parabola(&self, joint: usize) -> [f64; 3] {
        let [before, here, after] = self.errors.map(|e| e[joint]);
        [here, 0.5 * (after - before), 0.5 * (before + after) - here]
    }
}

/// Mean squared errors of the joints under delays.
pub(super) struct Scan {
    target_only: bool,
    step_s: f64,
    /// Errors at delays of −before … steps, one after the other.
    errors: Vec<Vec<f64>>,
    /// Delays below zero.
    before: usize,
    /// A delay near the lowest point, and the errors a quarter of a step before it, at it, and as much after it.
    fine: Option<(f64, [Vec<f64>; 3])>,
    floor: Vec<f64>,
    /// ½ n_eff of each joint.
    effective: Vec<f64>,
    /// Evidence of the confirming rows for the lowest point, in nats, joint by joint.
    held_out: Vec<f64>,
    /// Least score of a delay, and its least size, s.
    least: f64,
    least_s: f64,
    /// Least log-MSE that an effect has to gain on one joint.
    reduction: f64,
}

impl Scan {
    pub(super) fn new(question: &Question<'_>, investigation: &Investigation, target_only: bool) -> Self {
        let problem = &investigation.problem;
        let switches = model(investigation, target_only);
        let (fit, weights) = weighted_fit(problem, &switches, &investigation.floor);
        let shares = crate::evidence::residuals::shares(
            &investigation.rows,
            &investigation.partition,
            &investigation.layout,
            &switches,
            &fit.coefficients,
        );
        let mean_share = shares.iter().sum::<f64>() / shares.len().max(1) as f64;
        let segments = question.recordings.iter().flat_map(|r| &r.data.data.segments);
        let slowest_hz = segments.map(|s| s.rate_hz).fold(f64::INFINITY, f64::min);
        let step_s = 1.0 / (STEPS_PER_PERIOD * question.f_dyn_hz);
        let (ordered, free) = free_first(&switches);
        let used = used_columns(investigation, &switches);
        let mut trial = problem.total().clone();
        let rows = |j: usize| (problem.total()[0][j].rows + problem.total()[1][j].rows).max(1.0);
        let mut fitted = |delay_s: f64| -> (Vec<f64>, Vec<f64>) {
            shift(question, investigation, &used, target_only, delay_s, &mut trial);
            let fit = problem.part_fit(&trial, &ordered, free, &weights);
            let beta = problem.extend(&trial, &fit, (&ordered, free), &[], &weights);
            let [calibration, target] = problem.squared_errors(&trial, &ordered, &beta);
            ((0..problem.joints()).map(|j| (calibration[j] + target[j]) / rows(j)).collect(), beta)
        };
        let mut at = |delay_s: f64| fitted(delay_s).0;
        let mut scan = Self {
            target_only,
            step_s,
            errors: Vec::new(),
            before: 0,
            fine: None,
            floor: investigation.floor.clone(),
            effective: (0..problem.joints()).map(|j| 0.5 * shares[j] * rows(j)).collect(),
            held_out: vec![0.0; problem.joints()],
            least: question.selection.score,
            least_s: LEAST_OF_SAMPLE / slowest_hz,
            reduction: question.selection.least_log_error(mean_share * mean_rate_hz(&investigation.rows)),
        };
        let (first, last) = window(|k| scan.value(&at(f64::from(k) * step_s)));
        scan.errors = (first..=last).map(|k| at(f64::from(k) * step_s)).collect();
        scan.before = first.unsigned_abs() as usize;
        let mut center = scan.center_s();
        for _ in 0..CENTERINGS {
            let Some(center_s) = center else { break };
            scan.fine = Some((center_s, [-1.0, 0.0, 1.0].map(|by| at(center_s + by * FINE * step_s))));
            // A minimum near an end of the finer steps is looked at once more.
            center = scan
                .size()
                .map(|[delay_s, _]| delay_s)
                .filter(|d| (d - center_s).abs() > 0.5 * FINE * step_s);
        }
        if let Some([delay_s, _]) = scan.size() {
            let mut errors = |delay_s: f64| {
                let coefficients = fitted(delay_s).1;
                confirming_errors(question, investigation, (&ordered, &coefficients), target_only, delay_s)
            };
            let gain = |([none, _], [late, independent]): (&[f64; 2], &[f64; 2])| {
                if *none > 0.0 && *late > 0.0 { 0.5 * independent * (none / late).ln() } else { 0.0 }
            };
            scan.held_out = errors(0.0).iter().zip(&errors(delay_s)).map(gain).collect();
        }
        scan
    }

    /// The lowest point to be looked at once more, s; none where its deviation exceeds the span of the finer steps, over which errors
    /// differ by how rows are interpolated.
    fn center_s(&self) -> Option<f64> {
        let (center_s, std_s) = self.minimum(&self.around_lowest()?);
        (std_s < FINE * self.step_s).then_some(center_s)
    }

    /// The steps around the lowest one; none where the scan ended there.
    fn around_lowest(&self) -> Option<Around<'_>> {
        let lowest = self.lowest();
        if lowest < 1 || lowest + 1 >= self.errors.len() {
            return None;
        }
        let at_s = (lowest as f64 - self.before as f64) * self.step_s;
        let errors = [lowest - 1, lowest, lowest + 1].map(|k| self.errors[k].as_slice());
        Some(Around { at_s, step_s: self.step_s, errors })
    }

    /// The lowest point of V between three delays, s, and the deviation that its curvature means. A joint's mean squared error P is a
    /// parabola of the delay where this is short beside the periods of the motion; its logarithm is none. As log P ≤ log P₀ + (P −
    /// P₀)/P₀, the lowest point of Σ w P with w = ½ n_eff / P₀ is lower than where P₀ was taken, and is the next P₀.
    fn minimum(&self, around: &Around<'_>) -> (f64, f64) {
        let joints: Vec<([f64; 3], f64, f64)> = (0..self.effective.len())
            .map(|j| {
                let most = around.errors.iter().map(|e| e[j]).fold(f64::MIN_POSITIVE, f64::max);
                (around.parabola(j), self.effective[j], f64::EPSILON * most)
            })
            .collect();
        // Below what rounding leaves of the errors a parabola says nothing.
        let at = |u: f64| {
            joints.iter().map(move |([constant, slope, bend], effective, rounding)| {
                let mse = (constant + u * (slope + u * bend)).max(*rounding);
                ([effective / mse * (slope + 2.0 * bend * u), 2.0 * effective / mse * bend], *effective)
            })
        };
        let mut u = 0.0;
        for _ in 0..MOST_TURNS {
            let (slope, bend) = at(u).fold((0.0, 0.0), |sum, ([s, b], _)| (sum.0 + s, sum.1 + b));
            let next = (u - slope / bend).clamp(-1.0, 1.0);
            // A parabola that bends down has no minimum.
            if !(bend > 0.0 && next.is_finite()) || (next - u).abs() < CONVERGED {
                break;
            }
            u = next;
        }
        let curvature: f64 = at(u).map(|([s, b], effective)| b - s * s / effective).sum();
        (around.at_s + u * around.step_s, around.step_s / curvature.sqrt())
    }

    /// Σ_j ½ n_eff log(MSE / floor). What lies below the floor counts as well: it has its minimum there.
    fn value(&self, errors: &[f64]) -> f64 {
        (0..errors.len()).map(|j| self.effective[j] * self.log_error(errors, j)).sum()
    }

    fn log_error(&self, errors: &[f64], joint: usize) -> f64 {
        let floor = self.floor[joint].max(f64::MIN_POSITIVE);
        (errors[joint].max(f64::MIN_POSITIVE) / floor).ln()
    }

    fn lowest(&self) -> usize {
        let values: Vec<f64> = self.errors.iter().map(|e| self.value(e)).collect();
        (0..values.len()).min_by(|a, b| values[*a].total_cmp(&values[*b])).unwrap_or(0)
    }

    /// The lowest point of the scan, s, and the deviation that its curvature means.
    fn size(&self) -> Option<[f64; 2]> {
        let coarse = self.around_lowest()?;
        let fine = self.fine.as_ref().map(|(at_s, errors)| Around {
            at_s: *at_s,
            step_s: FINE * self.step_s,
            errors: errors.each_ref().map(Vec::as_slice),
        });
        let (delay_s, std_s) = self.minimum(&fine.unwrap_or(coarse));
        std_s.is_finite().then_some([delay_s, std_s])
    }

    /// The delay, if it is one. A delay acts mostly at reversals, whose samples are left out, so the gain on the other rows is small
    /// even for a real one. That joints agree on it is evidence of one clock; a single joint has to gain as much as other effects must.
    /// Fitted rows have to show it, and still do when what confirming rows say against it is subtracted.
    pub(super) fn delay(&self) -> Option<Delay> {
        let [delay_s, std_s] = self.size()?;
        // A delay of less than half a step is seen beside the steps alone.
        let steps = &self.errors[self.lowest()];
        let fine = self.fine.as_ref().map(|(_, around)| &around[1]);
        let least = fine.filter(|errors| self.value(errors) < self.value(steps)).unwrap_or(steps);
        let none = &self.errors[self.before];
        let gains: Vec<f64> = (0..self.effective.len())
            .map(|j| self.effective[j] * (self.log_error(none, j) - self.log_error(least, j)))
            .collect();
        let with_others: Vec<f64> =
            gains.iter().zip(&self.held_out).map(|(fitted, other)| fitted + other).collect();
        let score = self.score_of_all(&gains).min(self.score_of_all(&with_others));
        let joints = agreement(&self.of_joints())?;
        let agreed = joints.mean_s * delay_s > 0.0 && joints.is_clear();
        let delay = Delay { delay_s, std_s: std_s.max(joints.std_s), score, target_only: self.target_only };
        let clear = delay_s.abs() > self.least_s.max(CLEAR * std_s);
        (score > self.least && clear && agreed).then_some(delay)
    }

    /// The sum of what joints gain; 0 where all but the strongest gain too little, or a single joint does.
    fn score_of_all(&self, gains: &[f64]) -> f64 {
        let score: f64 = gains.iter().sum();
        let strongest = gains.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let is_common = match gains {
            [gain] => *gain > self.effective[0] * self.reduction,
            // Evidence of one joint alone is that of its own lag.
            _ => score - strongest > self.least,
        };
        if is_common { score } else { 0.0 }
    }

    /// The delay that each joint shows by itself, s, and its variance: the lowest point of a parabola through its mean squared errors
    /// around the lowest, of the delays from one step beyond none to one beyond the common delay. None of a joint whose errors have
    /// no minimum.
    fn of_joints(&self) -> Vec<Option<[f64; 2]>> {
        let (lowest, none) = (self.lowest(), self.before);
        let first = lowest.min(none).saturating_sub(1);
        let last = (lowest.max(none) + 1).min(self.errors.len() - 1);
        let of_joint = |joint: usize| {
            let error = |k: &usize| self.errors[*k][joint];
            let own = (first..=last).min_by(|a, b| error(a).total_cmp(&error(b)))?;
            let around = first.max(own.saturating_sub(PARABOLIC))..=last.min(own + PARABOLIC);
            let n = around.clone().count() as f64;
            let middle = 0.5 * (around.start() + around.end()) as f64;
            let errors = || around.clone().map(|k| (error(&k), k as f64 - middle));
            let square = errors().map(|(_, u)| u * u).sum::<f64>() / n;
            let spread = errors().map(|(_, u)| (u * u - square).powi(2)).sum::<f64>();
            let slope = errors().map(|(e, u)| e * u).sum::<f64>() / (n * square);
            let bend = errors().map(|(e, u)| e * (u * u - square)).sum::<f64>() / spread;
            let place = middle - none as f64 - 0.5 * slope / bend;
            let variance = error(&own) / (2.0 * bend * self.effective[joint]);
            // Whose deviation is longer than what was looked at tells none of these delays from another.
            let is_known = bend > 0.0 && variance > 0.0 && variance < n * n && place.is_finite();
            is_known.then_some([place * self.step_s, variance * self.step_s * self.step_s])
        };
        (0..self.effective.len()).map(of_joint).collect()
    }
}

/// The first and the last step around the lowest valley, those around none included. Friction that lags makes valleys of its own: which
/// one is the lowest is known when all have been looked into.
fn window(mut height: impl FnMut(i32) -> f64) -> (i32, i32) {
    let heights = (-STEPS..=STEPS).step_by(VALLEY).map(|k| (k, height(k)));
    let lowest = heights.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(k, _)| k);
    ((lowest - VALLEY as i32).min(-1), (lowest + VALLEY as i32).max(1))
}

/// The model under which delays are scanned: the baseline, what was found but for the column of a delay, and on every joint the laws
/// that stay beside delays. What imitates a delay has a coefficient of its own at each, which vanishes at the true one. Where the targets alone
/// are late, their friction is that of another day: inertia of a motion of the frequency f that is late by d is viscous friction of (2πf)² d I.
fn model(investigation: &Investigation, target_only: bool) -> Vec<Switch> {
    let stays = |group: &&Group| group.effect.stays_beside_delays;
    let found = investigation.selection.chosen.iter().map(|c| &investigation.groups[c.group]);
    let found = found.filter(|g| !is_delay(investigation, g));
    let mut all = investigation.base_switches.clone();
    let everywhere = !investigation.problem.has_reference();
    let staying = investigation.groups.iter().filter(stays).filter(|g| everywhere || !g.target_only());
    let of_friction = |j| investigation.model.group(ColumnGroup::JointDynamics(j));
    let of_targets = |column| Switch { column, target_only: true, nonnegative: false };
    let another = (0..investigation.problem.joints()).flat_map(of_friction).map(of_targets);
    let another = another.filter(|_| target_only);
    for switch in found.chain(staying).flat_map(|g| &g.switches).copied().chain(another) {
        if !all.iter().any(|s| s.column == switch.column && s.target_only == switch.target_only) {
            all.push(switch);
        }
    }
    all
}

/// The places of a model's columns among those of each joint.
fn used_columns(investigation: &Investigation, switches: &[Switch]) -> Vec<Vec<usize>> {
    let is_used = |column: usize| switches.iter().any(|s| s.column == column);
    let of_joint = |row: &Vec<usize>| (0..row.len()).filter(|k| is_used(row[*k])).collect();
    investigation.layout.rows.iter().map(of_joint).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scan(errors: Vec<Vec<f64>>) -> Scan {
        let joints = errors[0].len();
        Scan {
            target_only: false,
            step_s: 0.002,
            errors,
            before: 1,
            fine: None,
            floor: vec![1.0; joints],
            effective: vec![200.0; joints],
            held_out: vec![0.0; joints],
            least: 8.0,
            least_s: 0.0002,
            reduction: 0.05,
        }
    }

    #[test]
    fn a_minimum_on_all_joints_is_a_delay() {
        let error = |k: i32, at: f64| 1.0 + 0.2 * (f64::from(k) - at).powi(2);
        let found = scan((-1..8).map(|k| vec![error(k, 3.3), error(k, 3.3)]).collect()).delay().unwrap();
        assert!((found.delay_s - 0.0066).abs() < 0.0006, "{found:?}");
        assert!(found.std_s < 0.001);
        let mut early = scan((-5..2).map(|k| vec![error(k, -3.3); 2]).collect());
        early.before = 5;
        assert!((early.delay().unwrap().delay_s + 0.0066).abs() < 0.0006);
    }

    #[test]
    fn what_one_joint_alone_speaks_for_is_no_delay() {
        let error = |k: i32, curvature: f64| 1.0 + curvature * (f64::from(k) - 3.3).powi(2);
        let of = |others: f64| scan((-1..8).map(|k| vec![error(k, 0.2), error(k, others)]).collect()).delay();
        assert!(of(0.02).is_some());
        assert_eq!(of(0.001), None);
        // A single joint has no other that could agree.
        let single = |curvature: f64| scan((-1..8).map(|k| vec![error(k, curvature)]).collect()).delay();
        assert!(single(0.2).is_some());
        assert_eq!(single(0.004), None);
    }

    /// Interpolated rows have errors that ripple with the delay: over a quarter of a step the ripple is steeper than the parabola.
    #[test]
    fn a_broad_minimum_is_not_looked_for_between_the_steps() {
        let error = |k: f64| 1.0 + 0.004 * (k - 3.3).powi(2);
        let broad = scan((-1..8).map(|k| vec![error(f64::from(k)); 3]).collect());
        let sharp = scan((-1..8).map(|k| vec![1.0 + 50.0 * (error(f64::from(k)) - 1.0); 3]).collect());
        assert!(broad.center_s().is_none() && sharp.center_s().is_some());
        assert!((broad.size().unwrap()[0] - 3.3 * 0.002).abs() < 2e-4, "{:?}", broad.size());
    }

    /// Logarithms of errors that grow twentyfold within a step are no parabolas, and the lowest of them is beside the delay.
    #[test]
    fn a_delay_of_a_third_of_a_step_is_not_rounded() {
        let error = |k: i32| 1.0 + 80.0 * (f64::from(k) - 0.32).powi(2);
        let found = scan((-1..5).map(|k| vec![error(k); 3]).collect()).size().unwrap();
        assert!((found[0] - 0.32 * 0.002).abs() < 1e-8, "{found:?}");
        // Floors above the errors do not hide the minimum.
        let mut high = scan((-1..5).map(|k| vec![0.8 * error(k); 3]).collect());
        high.floor = vec![20.0; 3];
        assert!((high.size().unwrap()[0] - 0.32 * 0.002).abs() < 1e-8);
    }

    /// Errors of a band-limited motion are parabolas near their lowest point alone, and friction that lags has a valley of its own.
    #[test]
    fn a_long_delay_is_found_behind_a_shallow_valley() {
        let bell = |x: f64| (-0.5 * x * x).exp();
        let error = |k: f64| 2.0 - 0.2 * bell((k - 2.0) / 3.0) - 1.2 * bell((k - 31.0) / 6.0);
        let (first, last) = window(|k| error(f64::from(k)));
        assert!(first == -1 && (33..40).contains(&last), "{first} {last}");
        let errors = (first..=last).map(|k| [0.3, -0.4, 0.1].map(|off| error(f64::from(k) + off)).to_vec());
        let found = scan(errors.collect()).delay().unwrap();
        assert!((found.delay_s - 0.062).abs() < 0.001 && found.std_s < 0.001, "{found:?}");
    }

    #[test]
    fn joints_that_disagree_show_no_delay() {
        let error = |k: i32, at: f64| 1.0 + 0.2 * (f64::from(k) - at).powi(2);
        let at = |places: [f64; 4]| {
            scan((-1..9).map(|k| places.map(|at| error(k, at)).to_vec()).collect()).delay()
        };
        assert!(at([3.0, 3.1, 2.9, 3.2]).is_some());
        assert_eq!(at([6.0, 5.0, -1.0, 0.5]), None);
    }

    #[test]
    fn rows_that_nothing_was_fitted_to_speak_against() {
        let error = |k: i32| 1.0 + 0.002 * (f64::from(k) - 3.3).powi(2);
        let mut faint = scan((-1..8).map(|k| vec![error(k); 3]).collect());
        let score = faint.delay().unwrap().score;
        faint.held_out = vec![1.0; 3];
        assert_eq!(faint.delay().unwrap().score, score);
        faint.held_out = vec![(7.9 - score) / 3.0; 3];
        assert_eq!(faint.delay(), None);
    }

    #[test]
    fn what_one_joint_of_three_shows_is_none() {
        let error = |k: i32| 1.0 + 0.2 * (f64::from(k) - 3.0).powi(2);
        assert_eq!(scan((-1..8).map(|k| vec![error(k), 1.0, 1.0]).collect()).delay(), None);
    }

    #[test]
    fn a_minimum_at_no_shift_is_none() {
        let error = |k: i32| 1.0 + 0.2 * f64::from(k).powi(2);
        assert_eq!(scan((-1..8).map(|k| vec![error(k); 3]).collect()).delay(), None);
    }
}
