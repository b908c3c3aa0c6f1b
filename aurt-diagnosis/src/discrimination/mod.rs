//! The motion that decides what a diagnosis leaves open.
//!
//! Two explanations that describe the present recordings equally well predict different torques in other motions. For a motion
//! that is not recorded yet, [`Discrimination`] computes by how much the rival would fit worse if one of them is true: the
//! T-criterion of A. C. Atkinson and V. V. Fedorov (*The design of experiments for discriminating between two rival models*,
//! Biometrika 62, 1975), with all coefficients of the rival fitted anew to the present recordings and the motion together, its
//! law in all shapes from which the search began at once.
//! With S_B the second moments of the rival's columns X_B in the present recordings and β̂_A, β̂_B the fits to these,
//!
//! D_AB = ½ min_δ { ‖X_A β̂_A − X_B (β̂_B + δ)‖² + δᵀ S_B δ },
//!
//! rows in units of the noise and counted as far as they are independent. The logarithm of the ratio of likelihoods is then
//! normal with mean D and variance 2 D, and the test by which a diagnosis tells two explanations apart (Student's t over blocks of
//! time, one-sided, 5 %) decides with probability Φ(√(D/2) − t), with t of all blocks: an upper bound where few of them tell the two apart.
//!
//! An effect that is there or not is a nested explanation. It is claimed where its coefficients are as many deviations from zero as
//! Student's t of the blocks requires (1 %) and D reaches the least score, with probability Φ(√(2 D) − t), D that of the present recordings
//! and the motion together, min_b ½ ‖X_A β̂_A − X_B b‖². Of an effect that the model absorbs no recording knows the size: the probability
//! is the mean over sizes, ½ n s² f² with s the ratio of its torque to the noise, f the share of it that the model leaves and n the
//! independent rows, of being claimed, and of being preferred to the rival that, added to the model, leaves least of it.
//!
//! Moments add, so that those of a motion are the sum of those of its pieces.

mod discriminator;
mod doubt;
mod drives;
mod motion;
mod outlook;

pub use discriminator::Discriminator;
pub use doubt::{DeviationGoal, Doubt, Subject};
pub use drives::{DriveDiscrimination, DriveMoments};
pub use motion::MotionMoments;
pub use outlook::{Interval, Outlook};

use aurt_calibration::{ONE_SIDED_5, student};
use aurt_plugins::Registry;
use aurt_recording::Recording;
use statrs::distribution::{ContinuousCDF, Normal};

use crate::error::DiagnosisError;
use crate::evidence::baseline::weighted_fit;
use crate::evidence::gram::Moments;
use crate::evidence::problem::Problem;
use crate::investigation::{Fitted, Investigation};
use crate::recordings::rows::mean_rate_hz;
use crate::request::Question;
use doubt::{Contest, doubts};
use motion::add;
use outlook::together;

/// The doubts of a diagnosis, and what a motion would do about them.
#[derive(Debug)]
pub struct Discrimination<'a> {
    question: &'a Question<'a>,
    investigation: &'a Investigation,
    registry: &'a Registry,
    /// One over the residual's variance times the share of independent rows, joint by joint.
    weights: Vec<f64>,
    /// Share of the rows that is independent.
    share: f64,
    /// Share of a joint's mean square by which an effect has to lower it.
    reduction: f64,
    /// One over the variance of what the baseline leaves, by which the investigation tells what this absorbs.
    base_weights: Vec<f64>,
    /// The model that the investigation ends with.
    fitted: Fitted,
    doubts: Vec<Doubt>,
    contests: Vec<Contest>,
}

impl<'a> Discrimination<'a> {
    /// The doubts that an investigation leaves, and intervals that are `wanted` narrower.
    pub fn new(
        question: &'a Question<'a>,
        investigation: &'a Investigation,
        registry: &'a Registry,
        wanted: &[DeviationGoal],
    ) -> Self {
        let fitted = Fitted::new(investigation, investigation.switches());
        let share = investigation.mean_independent_share.clamp(0.01, 1.0);
        let weights = fitted.weights.iter().map(|weight| weight * share).collect();
        let Investigation { problem, base_switches, floor, .. } = investigation;
        let base_weights = of_moved_joints(problem, weighted_fit(problem, base_switches, floor).1);
        let weights = of_moved_joints(problem, weights);
        let (doubts, contests) = doubts(question, investigation, &fitted, wanted).into_iter().unzip();
        let independent_hz = share * mean_rate_hz(&investigation.rows);
        let reduction = question.selection.least_log_error(independent_hz).exp_m1();
        Self {
            question,
            investigation,
            registry,
            weights,
            share,
            reduction,
            base_weights,
            fitted,
            doubts,
            contests,
        }
    }
}

impl Discriminator for Discrimination<'_> {
    type Planned = MotionMoments;

    fn doubts(&self) -> &[Doubt] {
        &self.doubts
    }

    fn planned(&self, motion: &Recording) -> Result<MotionMoments, DiagnosisError> {
        self.moments(motion)
    }

    fn and(&self, mut one: MotionMoments, other: &MotionMoments) -> MotionMoments {
        add(&mut one.moments, &other.moments);
        one.largest.iter_mut().zip(&other.largest).for_each(|(most, other)| *most = most.max(*other));
        one
    }

    fn recorded_again(&self, other: &MotionMoments) -> Result<MotionMoments, DiagnosisError> {
        let total = self.investigation.problem.total();
        let rows = |of: &[Vec<Moments>; 2]| of.iter().flatten().map(|m| m.rows).sum::<f64>();
        let share = rows(&other.moments) / rows(total).max(1.0);
        let mut moments = other.moments.clone();
        for (sum, moments) in moments.iter_mut().flatten().zip(total.iter().flatten()) {
            sum.scale(0.0);
            sum.add(moments, share);
        }
        Ok(MotionMoments { moments, largest: Vec::new() })
    }

    fn outlook_of(&self, doubts: &[usize], planned: &MotionMoments) -> Vec<Outlook> {
        let all = together(self.investigation.problem.total(), planned);
        let mut absorbed = self.free(doubts, &all).into_iter();
        let outlook = |k: &usize| match &self.contests[*k] {
            Contest::Absorbed(subject, _) => {
                self.of_absorbed(subject, absorbed.next().unwrap_or_default(), &all)
            }
            Contest::Rivals(explanations) => self.of_rivals(explanations, planned),
            Contest::Indicated(explanations) => self.of_indicated(explanations, &all),
            Contest::Wide(subject, wanted) => self.of_wide(subject, wanted, &all),
        };
        doubts.iter().map(outlook).collect()
    }

    fn intervals(&self, planned: &MotionMoments) -> Vec<(Subject, Vec<Interval>)> {
        let after = self.narrowed(&together(self.investigation.problem.total(), planned));
        let groups = self.investigation.selection.chosen.iter().map(|c| &self.investigation.groups[c.group]);
        groups
            .map(|group| {
                let subject = Subject::of(group);
                let intervals = self.intervals_of(&subject, &after);
                (subject, intervals)
            })
            .collect()
    }

    fn largest<'m>(&self, planned: &'m MotionMoments) -> &'m [f64] {
        &planned.largest
    }

    fn encoders(&self) -> Vec<[f64; 2]> {
        let noise = self.investigation.noise.first();
        let positions = noise.iter().flat_map(|noise| &noise.positions);
        positions.map(|position| [position.step_rad.unwrap_or(0.0), position.white_rad]).collect()
    }

    fn nats_to_decide(&self, probability: f64) -> f64 {
        let blocks = self.investigation.problem.blocks();
        2.0 * (decisive(blocks) + Normal::standard().inverse_cdf(probability)).powi(2)
    }
}

/// Weights in which a joint without fitted rows, which rested or moved in what confirms alone, has the least of the others: the noise
/// that a motion of it will show is not known, and it has no residual to estimate it from.
fn of_moved_joints(problem: &Problem, mut weights: Vec<f64>) -> Vec<f64> {
    let has_rows: Vec<bool> = (0..weights.len()).map(|joint| problem.rows(joint, false) > 0.0).collect();
    let known = weights.iter().zip(&has_rows).filter(|(_, has_rows)| **has_rows);
    let least = known.map(|(weight, _)| *weight).fold(f64::INFINITY, f64::min);
    for (weight, _) in weights.iter_mut().zip(has_rows).filter(|(_, has_rows)| !has_rows) {
        *weight = if least.is_finite() { least } else { 0.0 };
    }
    weights
}

/// The probability that a diagnosis prefers the true one of two explanations, and the probability that it prefers the other, by
/// the expected logarithm D of their likelihoods' ratio and the number of blocks of time that it compares them on.
fn decided(nats: f64, blocks: usize) -> [f64; 2] {
    let in_deviations = (0.5 * nats.max(0.0)).sqrt();
    [in_deviations, -in_deviations].map(|z| Normal::standard().cdf(z - decisive(blocks)))
}

/// The probability that a diagnosis claims an effect that is there, by the expected logarithm D of the ratio of likelihoods with and
/// without it in all recordings, and that it claims one that is not. A score is such a logarithm, and √(2 D) deviations.
fn claimed(nats: f64, blocks: usize, score: f64) -> [f64; 2] {
    let least = student(Normal::standard().inverse_cdf(0.995), blocks.saturating_sub(1).max(1) as f64);
    let least = least.max((2.0 * score).sqrt());
    [(2.0 * nats.max(0.0)).sqrt(), 0.0].map(|deviations| Normal::standard().cdf(deviations - least))
}

/// The standard errors from which a diagnosis prefers one of two explanations, as in [`crate::search`].
fn decisive(blocks: usize) -> f64 {
    student(ONE_SIDED_5, blocks.saturating_sub(1).max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::{claimed, decided};

    #[test]
    fn more_evidence_decides_more_often_and_errs_less() {
        let [nothing, some, much] = [0.0, 4.0, 40.0].map(|nats| decided(nats, 1000));
        assert!((nothing[0] - 0.05).abs() < 1e-3 && (nothing[1] - 0.05).abs() < 1e-3, "{nothing:?}");
        assert!(nothing[0] < some[0] && some[0] < much[0] && much[0] > 0.99);
        assert!(nothing[1] > some[1] && some[1] > much[1]);
        // Few blocks decide less often.
        assert!(decided(4.0, 6)[0] < some[0]);
    }

    #[test]
    fn an_effect_as_far_from_zero_as_it_must_be_is_claimed_every_other_time() {
        let required = 4.032_f64; // Student's t, 1 %, of six blocks.
        assert!((claimed(0.5 * required * required, 6, 0.0)[0] - 0.5).abs() < 1e-3);
        assert!(claimed(0.0, 6, 0.0)[0] < 1e-3 && claimed(40.0, 6, 0.0)[0] > 0.99);
        assert!((claimed(18.0, 6, 18.0)[0] - 0.5).abs() < 1e-3, "the score decides where it is the greater");
    }
}
