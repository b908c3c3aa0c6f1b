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
pub mod recording;

use std::fmt::Debug;
use std::ops::Range;

use aurt_traits::{Columns, Invariant, Invariants, ModelError, ShapeParameter};
use recording::{Draw, Recording};
use thiserror::Error;

/// A model that does not do what it must or what it says of itself.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages name the fields")]
pub enum Violation {
    #[error("{during}: {source}")]
    Failed { during: &'static str, source: ModelError },
    #[error("`{model}` declares that it is {}, but {detail}", .invariant.in_words())]
    Invariant { model: String, invariant: Invariant, detail: String },
    #[error("`{model}`: {detail}")]
    Contract { model: String, detail: String },
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

/// Columns over a recording, or why there are none.
type Evaluated = Result<Vec<Vec<f64>>, Violation>;

/// Columns over `samples` samples, evaluated in pieces that end at `cuts`.
fn in_pieces(
    name: &str,
    count: usize,
    samples: usize,
    cuts: &[usize],
    mut evaluate: impl FnMut(Range<usize>, &mut Columns<'_>) -> Result<(), ModelError>,
) -> Evaluated {
    const UNTOUCHED: f64 = 1.25e77;
    /// Distance between columns beyond a series, so that writing beyond its end is seen.
    const PADDING: usize = 3;
    let broken = |detail: String| Violation::Contract { model: name.into(), detail };
    let mut columns = vec![Vec::with_capacity(samples); count];
    let mut ends = cuts.to_vec();
    ends.push(samples);
    ends.sort_unstable();
    let mut first = 0;
    for end in ends {
        let piece = end - first;
        let stride = piece + PADDING;
        let mut data = vec![UNTOUCHED; count * stride];
        evaluate(first..end, &mut Columns::new(&mut data, count, piece, stride))
            .map_err(|source| Violation::Failed { during: "evaluation", source })?;
        for (k, column) in columns.iter_mut().enumerate() {
            let (values, beyond) = data[k * stride..(k + 1) * stride].split_at(piece);
            if beyond.iter().any(|x| *x != UNTOUCHED) {
                return Err(broken(format!("writes beyond the end of column {k}")));
            }
            if let Some(n) = values.iter().position(|x| *x == UNTOUCHED) {
                return Err(broken(format!("does not write column {k}, sample {}", first + n)));
            }
            column.extend_from_slice(values);
        }
        first = end;
    }
    Ok(columns)
}

/// Checks that columns do not depend on where a series is split: at some places, and at every sample.
fn check_splits(
    name: &str,
    seed: u64,
    samples: usize,
    whole: &[Vec<f64>],
    evaluate: impl Fn(&[usize]) -> Evaluated,
) -> Result<(), Violation> {
    let mut draw = Draw::new(!seed);
    let some_cuts: Vec<usize> = (0..6).map(|_| draw.below(samples)).collect();
    let every_sample: Vec<usize> = (1..samples).collect();
    for cuts in [some_cuts, every_sample] {
        if let Some(place) = first_difference(whole, &evaluate(&cuts)?, AGREEMENT) {
            let detail = format!("depends on how the series is split, {place}");
            return Err(Violation::Contract { model: name.into(), detail });
        }
    }
    Ok(())
}

/// Where an invariant breaks that compares `whole`, the columns `over` a recording, with those over a changed one.
fn of_motion(
    invariant: Invariant,
    declared: Invariants,
    seed: u64,
    recording: &Recording,
    whole: &[Vec<f64>],
    over: &dyn Fn(&Recording) -> Evaluated,
) -> Result<Option<String>, Violation> {
    let changed = recording.clone();
    let memoryless = declared.contains(Invariant::Memoryless);
    Ok(match invariant {
        Invariant::EvenInLoad => first_difference(whole, &over(&changed.with_reversed_load())?, AGREEMENT),
        Invariant::OddInVelocity => {
            let reversed = if memoryless { changed.with_reversed_velocity() } else { changed.mirrored() };
            let mut other = over(&reversed)?;
            other.iter_mut().flatten().for_each(|x| *x = -*x);
            first_difference(whole, &other, AGREEMENT)
        }
        Invariant::ContinuousInVelocity if memoryless => {
            let beside_rest = |v| over(&recording.clone().with_velocity(v));
            step_at_rest(whole, &beside_rest(-1e-12)?, &beside_rest(1e-12)?)
        }
        Invariant::ContinuousInVelocity => {
            let jump = |samples| {
                let fine = Recording::closed(seed, recording.joints(), samples, 1, 0.3, 2.0);
                over(&fine).map(|columns| columns.iter().map(|c| largest_jump(c)).collect::<Vec<f64>>())
            };
            not_shrinking(&jump(2_000)?, &jump(100_000)?)
        }
        Invariant::RateIndependent => first_difference(whole, &over(&changed.slowed(3.0))?, AGREEMENT),
        _ => None,
    })
}

/// The largest difference between neighbouring samples.
fn largest_jump(column: &[f64]) -> f64 {
    column.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max)
}

/// A column that differs on the two sides of rest by more than 10⁻⁶ of its size (or of 10⁻³, if it is smaller).
fn step_at_rest(whole: &[Vec<f64>], before: &[Vec<f64>], after: &[Vec<f64>]) -> Option<String> {
    let size = |column: &[f64]| column.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    whole.iter().zip(before.iter().zip(after)).enumerate().find_map(|(k, (all, (b, a)))| {
        let step = b.iter().zip(a).map(|(b, a)| (a - b).abs()).fold(0.0, f64::max);
        (step > 1e-6 * size(all).max(1e-3)).then(|| format!("column {k} steps by {step} at rest"))
    })
}

/// A column whose largest jump does not shrink with the distance between samples has a step.
fn not_shrinking(coarse: &[f64], fine: &[f64]) -> Option<String> {
    coarse.iter().zip(fine).enumerate().find_map(|(k, (c, f))| {
        (*f > 0.2 * c).then(|| format!("column {k} steps by {f} however finely it is sampled"))
    })
}

/// What shape parameters ask of a model: values come back as they were set, bounds hold, every parameter matters.
pub(crate) fn check_shape<M: Debug>(
    model: &M,
    name: &str,
    parameters: impl Fn(&M) -> Vec<ShapeParameter>,
    set: impl Fn(&[f64]) -> Result<M, ModelError>,
    columns: impl Fn(&M) -> Evaluated,
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
