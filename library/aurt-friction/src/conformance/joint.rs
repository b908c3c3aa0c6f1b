//! Checks of a [`JointModel`] by itself, whatever slot it is for.

use aurt_traits::{Columns, CoulombModel, HysteresisModel, Invariant, JointModel, JointSeries, ViscousBasis};

use super::{
    AGREEMENT, Violation, first_difference,
    recording::{Draw, Recording},
};

/// Samples of the random recordings.
const SAMPLES: usize = 600;
/// Distance between columns, larger than a series so that writing beyond its end is seen.
const PADDING: usize = 3;

/// Runs every check on random recordings of `seed`: columns as announced and finite, independence of how the
/// series is split, the declared invariants.
///
/// # Errors
/// The first [`Violation`] that is found.
pub fn check(model: &dyn JointModel, seed: u64) -> Result<(), Violation> {
    let recording = Recording::random(seed, 1, SAMPLES);
    let whole = evaluate(model, &recording.joint(0), &[])?;
    check_columns(model, &whole)?;
    let mut draw = Draw::new(!seed);
    let some_cuts: Vec<usize> = (0..6).map(|_| draw.below(SAMPLES)).collect();
    let every_sample: Vec<usize> = (1..SAMPLES).collect();
    for cuts in [some_cuts, every_sample] {
        let split = evaluate(model, &recording.joint(0), &cuts)?;
        if let Some(place) = first_difference(&whole, &split, AGREEMENT) {
            return Err(broken(model, format!("depends on how the series is split, {place}")));
        }
    }
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
    const UNTOUCHED: f64 = 1.25e77;
    let count = model.columns().len();
    let mut columns = vec![Vec::with_capacity(series.samples()); count];
    let mut state = model.initial_state(&series.slice(0..1));
    if state.len() != model.state_len() {
        return Err(broken(
            model,
            format!("announces {} state variables, has {}", model.state_len(), state.len()),
        ));
    }
    let mut ends = cuts.to_vec();
    ends.push(series.samples());
    ends.sort_unstable();
    let mut first = 0;
    for end in ends {
        let samples = end - first;
        let stride = samples + PADDING;
        let mut data = vec![UNTOUCHED; count * stride];
        let mut out = Columns::new(&mut data, count, samples, stride);
        model
            .evaluate(&series.slice(first..end), &mut state, &mut out)
            .map_err(|source| Violation::Failed { during: "evaluation", source })?;
        for (k, column) in columns.iter_mut().enumerate() {
            let (values, beyond) = data[k * stride..(k + 1) * stride].split_at(samples);
            if beyond.iter().any(|x| *x != UNTOUCHED) {
                return Err(broken(model, format!("writes beyond the end of column {k}")));
            }
            if let Some(n) = values.iter().position(|x| *x == UNTOUCHED) {
                return Err(broken(model, format!("does not write column {k}, sample {}", first + n)));
            }
            column.extend_from_slice(values);
        }
        first = end;
    }
    Ok(columns)
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
        Invariant::EvenInLoad => {
            first_difference(whole, &over(&recording.clone().with_reversed_load())?, AGREEMENT)
        }
        Invariant::Positive => not_positive(whole),
        Invariant::BoundedByOne => {
            first_sample(whole, |_, x| x.abs() > 1.0).map(|(k, n, x)| format!("column {k}, sample {n}: {x}"))
        }
        Invariant::OddInVelocity => {
            let reversed = if model.invariants().contains(Invariant::Memoryless) {
                recording.clone().with_reversed_velocity()
            } else {
                recording.clone().mirrored()
            };
            let mut other = over(&reversed)?;
            other.iter_mut().flatten().for_each(|x| *x = -*x);
            first_difference(whole, &other, AGREEMENT)
        }
        Invariant::SignOfVelocity => {
            let velocity = recording.joint(0).velocity_rad_s;
            first_sample(whole, |n, x| x * velocity[n] < 0.0 || (velocity[n] == 0.0 && x != 0.0))
                .map(|(k, n, x)| format!("column {k}, sample {n}: {x} at {} rad/s", velocity[n]))
        }
        Invariant::ContinuousInVelocity if model.invariants().contains(Invariant::Memoryless) => {
            let beside_rest = |v| over(&recording.clone().with_velocity(v));
            step_at_rest(whole, &beside_rest(-1e-12)?, &beside_rest(1e-12)?)
        }
        Invariant::ContinuousInVelocity => {
            let jump = |samples| {
                let fine = Recording::closed(seed, 1, samples, 1, 0.3, 2.0);
                over(&fine).map(|columns| columns.iter().map(|c| largest_jump(c)).collect::<Vec<f64>>())
            };
            not_shrinking(&jump(2_000)?, &jump(100_000)?)
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
        Invariant::RateIndependent => {
            first_difference(whole, &over(&recording.clone().slowed(3.0))?, AGREEMENT)
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
        _ => None,
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

/// The largest difference between neighbouring samples.
pub(crate) fn largest_jump(column: &[f64]) -> f64 {
    column.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max)
}

/// A column that differs on the two sides of rest by more than 10⁻⁶ of its size (or of 10⁻³, if it is smaller).
pub(crate) fn step_at_rest(whole: &[Vec<f64>], before: &[Vec<f64>], after: &[Vec<f64>]) -> Option<String> {
    let size = |column: &[f64]| column.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    whole.iter().zip(before.iter().zip(after)).enumerate().find_map(|(k, (all, (b, a)))| {
        let step = b.iter().zip(a).map(|(b, a)| (a - b).abs()).fold(0.0, f64::max);
        (step > 1e-6 * size(all).max(1e-3)).then(|| format!("column {k} steps by {step} at rest"))
    })
}

/// A column whose largest jump does not shrink with the distance between samples has a step.
pub(crate) fn not_shrinking(coarse: &[f64], fine: &[f64]) -> Option<String> {
    coarse.iter().zip(fine).enumerate().find_map(|(k, (c, f))| {
        (*f > 0.2 * c).then(|| format!("column {k} steps by {f} however finely it is sampled"))
    })
}

/// ∫ column dq by the trapezoidal rule, and the same of the magnitudes.
pub(crate) fn work(column: &[f64], position: &[f64]) -> (f64, f64) {
    column.windows(2).zip(position.windows(2)).fold((0.0, 0.0), |(work, turnover), (c, q)| {
        let part = 0.5 * (c[0] + c[1]) * (q[1] - q[0]);
        (work + part, turnover + part.abs())
    })
}
