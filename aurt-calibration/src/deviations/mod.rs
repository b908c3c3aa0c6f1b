//! How far coefficients may be off: noise that remembers, models that misfit, recordings that repeat.
//!
//! The parallel filter correlates neighbouring rows, a drive's current has a memory of its own, and what the model lacks
//! comes back with the motion. Counting rows as independent makes intervals too short. With g = Wᵀ Ω⁻¹ e the score of the
//! rows and A = Wᵀ Ω⁻¹ W,
//!
//! Cov ζ̂ = A⁻¹ (Σ_j σ_j⁻⁴ W_jᵀ Γ_j W_j) A⁻¹ · φ,
//!
//! where Γ_j is the covariance of joint j's residual over time, from an autoregression fitted to it (a heteroscedasticity and
//! autocorrelation consistent sandwich with a parametric middle: Newey, West 1987; Andrews, Monahan 1992; den Haan, Levin
//! 1997), and φ ≥ 1 compares the scores of clusters of rows (recordings, and stretches of them) with what Γ lets expect: a
//! model that errs differently at other times widens its own intervals.
//!
//! A recording that is listed k times counts k times in ζ̂ and once in its intervals.

mod autoregression;
mod clusters;
mod sandwich;

pub(crate) use sandwich::{Lift, Sandwich, product, root_of_gram};
