//! The first batches of a library's model: evaluated between guards, and held to what the model declares of itself.

use aurt_traits::abi::Series;
use aurt_traits::{Columns, Invariant, Invariants, JointSeries};

use super::instance::{Fault, Instance};

/// Values behind each column and behind the state that nobody may touch.
const GUARDS: usize = 8;
/// A NaN that no calculation gives.
const GUARD: u64 = 0x7ff8_a017_5afe_0001;
/// Difference that rounding may make, relative and absolute.
const TOLERANCE: f64 = 1e-9;

fn is_guard(value: &f64) -> bool {
    value.to_bits() == GUARD
}

/// Evaluates into memory of which every column, and the state, ends in guards, and takes over what is right.
pub(super) fn evaluate(
    instance: &Instance,
    series: &Series,
    state: &mut [f64],
    out: &mut Columns<'_>,
) -> Result<(), Fault> {
    let (columns, samples) = (out.columns(), out.samples());
    let stride = samples + GUARDS;
    let guard = f64::from_bits(GUARD);
    // Guards before the first column too.
    let mut memory = vec![guard; GUARDS + columns * stride];
    let mut guarded_state = vec![guard; state.len() + GUARDS];
    guarded_state[..state.len()].copy_from_slice(state);
    let (own_state, after_state) = guarded_state.split_at_mut(state.len());
    for k in 0..columns {
        let first = GUARDS + k * stride;
        memory[first..first + samples].copy_from_slice(out.column(k));
    }
    if columns > 0 {
        let mut own = Columns::new(&mut memory[GUARDS..], columns, samples, stride);
        instance.evaluate(series, own_state, &mut own)?;
    }
    if !after_state.iter().all(is_guard) {
        return Err(Fault(format!("it writes beyond its state of {} values", state.len())));
    }
    if !memory[..GUARDS].iter().all(is_guard) {
        return Err(Fault("it writes before its first column".into()));
    }
    for k in 0..columns {
        let (column, after) = memory[GUARDS + k * stride..GUARDS + (k + 1) * stride].split_at(samples);
        if let Some(far) = after.iter().rposition(|value| !is_guard(value)) {
            let beyond = far + 1;
            return Err(Fault(format!(
                "it writes {beyond} values too many into column {k}: {samples} samples were asked for"
            )));
        }
        out.column_mut(k).copy_from_slice(column);
    }
    state.copy_from_slice(own_state);
    Ok(())
}

/// Evaluates series anew from the state before them.
type Again<'a> = &'a mut dyn FnMut(&JointSeries<'_>, &mut Columns<'_>) -> Result<(), Fault>;

/// Holds the columns of a batch to the invariants that its model declares and that one batch can show.
pub(super) fn check_invariants(
    declared: Invariants,
    series: &JointSeries<'_>,
    out: &Columns<'_>,
    again: Again<'_>,
) -> Result<(), Fault> {
    let broken = |invariant: Invariant, k: usize, sample: usize, what: String| {
        Err(Fault(format!(
            "it declares that it is {}, but column {k} at sample {sample} of a batch {what}",
            invariant.in_words()
        )))
    };
    for k in 0..out.columns() {
        for (sample, value) in out.column(k).iter().enumerate() {
            let velocity = series.velocity_rad_s[sample];
            if declared.contains(Invariant::BoundedByOne) && value.abs() > 1.0 + TOLERANCE {
                return broken(Invariant::BoundedByOne, k, sample, format!("is {value}"));
            }
            if declared.contains(Invariant::Positive) && *value < -TOLERANCE {
                return broken(Invariant::Positive, k, sample, format!("is {value}"));
            }
            if declared.contains(Invariant::SignOfVelocity) && value * velocity < -TOLERANCE {
                let what = format!("is {value} at {velocity} rad/s");
                return broken(Invariant::SignOfVelocity, k, sample, what);
            }
        }
    }
    if declared.contains(Invariant::EvenInLoad) {
        let load: Vec<f64> = series.load_torque.iter().map(|load| -load).collect();
        let mut memory = vec![0.0; out.columns() * out.samples()];
        let mut other = Columns::new(&mut memory, out.columns(), out.samples(), out.samples());
        again(&JointSeries { load_torque: &load, ..*series }, &mut other)?;
        for k in 0..out.columns() {
            let pairs = out.column(k).iter().zip(other.column(k)).enumerate();
            for (sample, (a, b)) in pairs {
                // Written so that a NaN is a difference too.
                let same = (a - b).abs() <= TOLERANCE * (1.0 + a.abs());
                if !same {
                    let what = format!("is {a}, and {b} at the opposite load");
                    return broken(Invariant::EvenInLoad, k, sample, what);
                }
            }
        }
    }
    Ok(())
}
