//! What every model must hold to, whoever wrote it: checks over any [`JointModel`](aurt_traits::JointModel) or
//! [`ArmTerm`](aurt_traits::ArmTerm), static or loaded from a library.
//!
//! [`joint::check`] and [`arm::check`] drive a model through random recordings and compare it with what the traits
//! ask of all models and with the invariants that it declares of itself. A plugin's own tests can call them.
//!
//! ```
//! use aurt_friction::{conformance::joint, hysteresis::dahl::Dahl};
//!
//! for seed in 0..4 {
//!     joint::check(&Dahl::default(), seed).unwrap();
//! }
//! ```

pub mod arm;
pub mod joint;
pub mod least_squares;
pub mod recording;

use std::fmt::Debug;

use aurt_traits::{Invariant, ModelError, ShapeParameter};
use thiserror::Error;

/// A model that does not do what it must or what it says of itself.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum Violation {
    /// The model reported an error where it must not.
    #[error("{during}: {source}")]
    Failed {
        /// What was asked of it.
        during: &'static str,
        /// What it reported.
        source: ModelError,
    },
    /// A declared invariant does not hold.
    #[error("`{model}` declares that it is {}, but {detail}", .invariant.in_words())]
    Invariant {
        /// The model.
        model: String,
        /// The invariant.
        invariant: Invariant,
        /// Where it broke.
        detail: String,
    },
    /// Something that the traits ask of every model does not hold.
    #[error("`{model}`: {detail}")]
    Contract {
        /// The model.
        model: String,
        /// What broke, and where.
        detail: String,
    },
}

/// Largest difference between two evaluations that must agree, relative to the larger of 1 and the value.
pub(crate) const AGREEMENT: f64 = 1e-12;

/// The first place where two sets of columns differ by more than `tolerance`.
pub(crate) fn first_difference(a: &[Vec<f64>], b: &[Vec<f64>], tolerance: f64) -> Option<String> {
    for (k, (left, right)) in a.iter().zip(b).enumerate() {
        for (n, (x, y)) in left.iter().zip(right).enumerate() {
            let agree = (x - y).abs() <= tolerance * x.abs().max(1.0);
            if !agree {
                return Some(format!("column {k}, sample {n}: {x:e} against {y:e}"));
            }
        }
    }
    None
}

/// What shape parameters ask of a model: values come back as they were set, bounds hold, every parameter matters.
pub(crate) fn check_shape<M: Debug>(
    model: &M,
    name: &str,
    parameters: impl Fn(&M) -> Vec<ShapeParameter>,
    set: impl Fn(&[f64]) -> Result<M, ModelError>,
    columns: impl Fn(&M) -> Result<Vec<Vec<f64>>, Violation>,
) -> Result<(), Violation> {
    let broken = |detail: String| Violation::Contract { model: name.into(), detail };
    let present = parameters(model);
    let values: Vec<f64> = present.iter().map(|p| p.value).collect();
    let before = columns(model)?;
    for (k, p) in present.iter().enumerate() {
        if !(p.lower < p.upper && (p.lower..=p.upper).contains(&p.value)) {
            return Err(broken(format!("shape parameter `{}` = {} is out of its bounds", p.name, p.value)));
        }
        if present[..k].iter().any(|other| other.name == p.name) {
            return Err(broken(format!("two shape parameters are called `{}`", p.name)));
        }
        let mut matters = false;
        for bound in [p.lower, p.upper] {
            let mut wanted = values.clone();
            wanted[k] = bound;
            let moved = set(&wanted)
                .map_err(|source| Violation::Failed { during: "setting shape parameters", source })?;
            let found: Vec<f64> = parameters(&moved).iter().map(|p| p.value).collect();
            if found != wanted {
                return Err(broken(format!("shape parameters set to {wanted:?} read {found:?}")));
            }
            let after = columns(&moved)?;
            if let Some((c, _)) =
                after.iter().enumerate().find(|(_, column)| column.iter().any(|x| !x.is_finite()))
            {
                return Err(broken(format!("with `{}` = {bound} column {c} is not finite", p.name)));
            }
            matters |= first_difference(&before, &after, 1e-9).is_some();
        }
        if !matters {
            return Err(broken(format!("shape parameter `{}` changes nothing", p.name)));
        }
        for outside in [p.lower - 0.01 * p.lower.abs() - 1e-3 * (p.upper - p.lower), f64::NAN] {
            let mut wanted = values.clone();
            wanted[k] = outside;
            if set(&wanted).is_ok() {
                return Err(broken(format!("shape parameter `{}` takes {outside}", p.name)));
            }
        }
    }
    if set(&[values, vec![1.0]].concat()).is_ok() {
        return Err(broken("takes one shape parameter too many".into()));
    }
    Ok(())
}
