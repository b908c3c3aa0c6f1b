//! The motion that decides what a diagnosis leaves open.
//!
//! Two explanations that describe the present recordings equally well predict different torques in other motions. For a motion
//! that is not recorded yet, [`Discrimination`] computes by how much the rival would fit worse if one of them is true: the
//! T-criterion of A. C. Atkinson and V. V. Fedorov (*The design of experiments for discriminating between two rival models*,
//! Biometrika 62, 1975), with all coefficients of the rival fitted anew to the present recordings and the motion together.
//! With S_B the second moments of the rival's columns X_B in the present recordings and β̂_A, β̂_B the fits to these,
//!
//! D_AB = ½ min_δ { ‖X_A β̂_A − X_B (β̂_B + δ)‖² + δᵀ S_B δ },
//!
//! rows in units of the noise and counted as far as they are independent. The logarithm of the ratio of likelihoods is then
//! normal with mean D and variance 2 D, and the test by which a diagnosis tells two explanations apart (one-sided, 5 %)
//! decides with probability Φ(√(D/2) − 1.645).
//!
//! Moments add, so that those of a motion are the sum of those of its pieces.

mod doubt;
mod outlook;
mod planned;

pub use doubt::{Doubt, Subject, Wanted};
pub use outlook::{Interval, Outlook};
pub use planned::Planned;

use aurt_plugins::Registry;
use statrs::distribution::{ContinuousCDF, Normal};

use crate::investigation::{Fitted, Investigation};
use crate::request::Question;
use doubt::doubts;

/// One-sided 5 % of the standard normal distribution, with which a diagnosis tells two explanations apart.
const DECIDED: f64 = 1.644_853_626_951_472_2;

/// The doubts of a diagnosis, and what a motion would do about them.
#[derive(Debug)]
pub struct Discrimination<'a> {
    question: &'a Question<'a>,
    investigation: &'a Investigation,
    registry: &'a Registry,
    /// One over the residual's variance times the share of independent rows, joint by joint.
    weights: Vec<f64>,
    /// The model that the investigation ends with.
    fitted: Fitted,
    doubts: Vec<Doubt>,
}

impl<'a> Discrimination<'a> {
    /// The doubts that an investigation leaves, and intervals that are `wanted` narrower.
    #[must_use]
    pub fn new(
        question: &'a Question<'a>,
        investigation: &'a Investigation,
        registry: &'a Registry,
        wanted: &[Wanted],
    ) -> Self {
        let fitted = Fitted::new(investigation, investigation.switches());
        let share = investigation.mean_independent_share.clamp(0.01, 1.0);
        let weights = fitted.weights.iter().map(|weight| weight * share).collect();
        let doubts = doubts(question, investigation, &fitted, wanted);
        Self { question, investigation, registry, weights, fitted, doubts }
    }

    /// What is open.
    #[must_use]
    pub fn doubts(&self) -> &[Doubt] {
        &self.doubts
    }
}

/// The probability that a diagnosis prefers the true one of two explanations, and the probability that it prefers the other, by
/// the expected logarithm D of their likelihoods' ratio.
#[must_use]
pub fn decided(nats: f64) -> [f64; 2] {
    let in_deviations = (0.5 * nats.max(0.0)).sqrt();
    [in_deviations - DECIDED, -in_deviations - DECIDED].map(|z| Normal::standard().cdf(z))
}

/// The expected logarithm of the ratio of likelihoods from which a diagnosis decides rightly with a probability.
#[must_use]
pub fn nats_to_decide(probability: f64) -> f64 {
    2.0 * (DECIDED + Normal::standard().inverse_cdf(probability)).powi(2)
}

#[cfg(test)]
mod tests {
    use super::{decided, nats_to_decide};

    #[test]
    fn more_evidence_decides_more_often_and_errs_less() {
        let [nothing, some, much] = [0.0, 4.0, 40.0].map(decided);
        assert!((nothing[0] - 0.05).abs() < 1e-9 && (nothing[1] - 0.05).abs() < 1e-9);
        assert!(nothing[0] < some[0] && some[0] < much[0] && much[0] > 0.99);
        assert!(nothing[1] > some[1] && some[1] > much[1]);
        assert!((decided(nats_to_decide(0.9))[0] - 0.9).abs() < 1e-6);
    }
}
