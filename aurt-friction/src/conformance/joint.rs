//! Checks of a [`JointModel`] by itself, whatever slot it is for.

use aurt_traits::{CoulombModel, HysteresisModel, Invariant, JointModel, JointSeries, ViscousBasis};

use super::recording::{Draw, Recording};
use super::{AGREEMENT, Violation, check_splits, first_difference, in_pieces, of_motion};

/// Samples of the random recordings.
const SAMPLES: usize = 600;

/// Runs every check on random recordings of `seed`: columns as announced and finite, independence of how the
/// series is split, the declared invariants.
///
/// # Errors
/// The first [`Violation`] that is found.
pub fn check(model: &dyn JointModel, seed: u64) -> Result<(), Violation> {
    let recording = Recording::random(seed, 1, SAMPLES);
    let whole = evaluate(model, &recording.joint(0), &[])?;
    check_columns(model, &whole)?;
    check_splits(model.name(), seed, SAMPLES, &whole, |cuts| evaluate(model, &recording.joint(0), cuts))?;
    if !model.reads_load() {
        let other = evaluate(model, &recording.clone().with_reversed_load().joint(0), &[])?;
        let none = evaluate(model, &JointSeries { load_torque: &[0.0; SAMPLES], ..recording.joint(0) }, &[])?;
        if whole != other || whole != none {
            return Err(broken(
                model,
                "says that it does not read the load torque, but depends on it".to_owned(),
            ));
        }
    }
    for invariant in model.invariants().iter() {
        check_invariant(model, invariant, seed, &recording, &whole)?;
    }
    Ok(())
}

/// The model's columns over `series`, evaluated in pieces that end at `cuts` with the state carried over.
///
/// # Errors
/// [`Violation`] if the model fails, has another state than announced, or writes beyond its columns.
pub fn evaluate(
    model: &dyn JointModel,
    series: &JointSeries<'_>,
    cuts: &[usize],
) -> Result<Vec<Vec<f64>>, Violation> {
    let count = model.columns().len();
    let mut state = model.initial_state(&series.slice(0..1));
    if state.len() != model.state_len() {
        return Err(broken(
            model,
            format!("announces {} state variables, has {}", model.state_len(), state.len()),
        ));
    }
    in_pieces(model.name(), count, series.samples(), cuts, |piece, out| {
        model.evaluate(&series.slice(piece), &mut state, out)
    })
}

/// A boxed model of any slot, as a [`JointModel`] that can be copied.
pub trait Slotted: Clone + std::fmt::Debug {
    /// The model.
    fn model(&self) -> &dyn JointModel;
    /// The model, to be changed.
    fn model_mut(&mut self) -> &mut dyn JointModel;
}

macro_rules! slotted {
    ($($slot:ident),*) => {$(
        impl Slotted for Box<dyn $slot> {
            fn model(&self) -> &dyn JointModel {
                &**self
            }

            fn model_mut(&mut self) -> &mut dyn JointModel {
                &mut **self
            }
        }
    )*};
}

slotted!(CoulombModel, HysteresisModel, ViscousBasis);

/// Checks the shape parameters of a model: values come back as they were set, bounds hold, every one matters.
///
/// # Errors
/// The first [`Violation`] that is found.
pub fn check_shape(model: &impl Slotted, seed: u64) -> Result<(), Violation> {
    let recording = Recording::random(seed, 1, SAMPLES);
    super::check_shape(
        model,
        model.model().name(),
        |m| m.model().shape_parameters(),
        |values| {
            let mut moved = model.clone();
            moved.model_mut().set_shape(values)?;
            Ok(moved)
        },
        |m| evaluate(m.model(), &recording.joint(0), &[]),
    )
}

fn broken(model: &dyn JointModel, detail: String) -> Violation {
    Violation::Contract { model: model.name().into(), detail }
}

fn check_columns(model: &dyn JointModel, columns: &[Vec<f64>]) -> Result<(), Violation> {
    let parameters = model.columns();
    for (k, p) in parameters.iter().enumerate() {
        if p.name.is_empty() || p.unit.is_empty() || parameters[..k].iter().any(|o| o.name == p.name) {
            return Err(broken(model, format!("column {k} needs a name of its own and a unit, has {p:?}")));
        }
        if let Some(n) = columns[k].iter().position(|x| !x.is_finite()) {
            return Err(broken(model, format!("column {k}, sample {n} is {}", columns[k][n])));
        }
    }
    Ok(())
}

fn check_invariant(
    model: &dyn JointModel,
    invariant: Invariant,
    seed: u64,
    recording: &Recording,
    whole: &[Vec<f64>],
) -> Result<(), Violation> {
    let over = |recording: &Recording| evaluate(model, &recording.joint(0), &[]);
    let detail = match invariant {
        Invariant::Positive => not_positive(whole),
        Invariant::BoundedByOne => {
            first_sample(whole, |_, x| x.abs() > 1.0).map(|(k, n, x)| format!("column {k}, sample {n}: {x}"))
        }
        Invariant::SignOfVelocity => {
            let velocity = recording.joint(0).velocity_rad_s;
            first_sample(whole, |n, x| x * velocity[n] < 0.0 || (velocity[n] == 0.0 && x != 0.0))
                .map(|(k, n, x)| format!("column {k}, sample {n}: {x} at {} rad/s", velocity[n]))
        }
        Invariant::Passive => {
            let mut found = None;
            for amplitude in [1e-4, 1e-3, 1e-2, 0.1, 1.0] {
                let closed = Recording::closed(seed, 1, 8_001, 2, amplitude, 1.3);
                let position = closed.joint(0).position_rad;
                let columns = over(&closed)?;
                found = found.or_else(|| {
                    columns.iter().enumerate().find_map(|(k, column)| {
                        let (work, turnover) = work(column, position);
                        (work < -1e-6 * turnover).then(|| {
                            format!("column {k} does the work {work:e} over a cycle of {amplitude} rad")
                        })
                    })
                });
            }
            found
        }
        Invariant::Memoryless => {
            let series = recording.joint(0);
            let mut draw = Draw::new(seed);
            let mut found = None;
            for _ in 0..40 {
                let n = draw.below(series.samples());
                let alone = evaluate(model, &series.slice(n..n + 1), &[])?;
                let same: Vec<Vec<f64>> = whole.iter().map(|c| vec![c[n]]).collect();
                found = found.or_else(|| first_difference(&same, &alone, AGREEMENT));
            }
            found
        }
        other => of_motion(other, model.invariants(), seed, recording, whole, &over)?,
    };
    match detail {
        Some(detail) => Err(Violation::Invariant { model: model.name().into(), invariant, detail }),
        None => Ok(()),
    }
}

fn not_positive(columns: &[Vec<f64>]) -> Option<String> {
    if let Some((k, n, x)) = first_sample(columns, |_, x| x < 0.0) {
        return Some(format!("column {k}, sample {n}: {x}"));
    }
    let everywhere = columns.iter().any(|c| c.iter().all(|x| *x > 0.0));
    (!columns.is_empty() && !everywhere).then(|| "no column is positive everywhere".to_owned())
}

fn first_sample(columns: &[Vec<f64>], is: impl Fn(usize, f64) -> bool) -> Option<(usize, usize, f64)> {
    columns
        .iter()
        .enumerate()
        .find_map(|(k, column)| column.iter().enumerate().find(|(n, x)| is(*n, **x)).map(|(n, x)| (k, n, *x)))
}

/// ∫ column dq by the trapezoidal rule, and the same of the magnitudes.
pub(crate) fn work(column: &[f64], position: &[f64]) -> (f64, f64) {
    column.windows(2).zip(position.windows(2)).fold((0.0, 0.0), |(work, turnover), (c, q)| {
        let part = 0.5 * (c[0] + c[1]) * (q[1] - q[0]);
        (work + part, turnover + part.abs())
    })
}
