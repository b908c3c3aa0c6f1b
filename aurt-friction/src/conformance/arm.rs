//! Checks of an [`ArmTerm`].

use aurt_traits::{ArmTerm, Columns, Invariant, RigidBodyRegressor};

use super::joint::work;
use super::recording::{Draw, Recording};
use super::{AGREEMENT, Violation, check_splits, first_difference, in_pieces, of_motion};

/// Samples of the random recordings.
const SAMPLES: usize = 400;

/// Runs every check on random recordings of `seed` with the robot `body`: columns as announced and finite,
/// independence of how the series is split, the declared invariants.
///
/// # Errors
/// The first [`Violation`] that is found.
pub fn check(term: &dyn ArmTerm, body: &dyn RigidBodyRegressor, seed: u64) -> Result<(), Violation> {
    let recording = Recording::random(seed, body.joints(), SAMPLES);
    let whole = evaluate(term, body, &recording, &[])?;
    check_columns(term, body, &whole)?;
    check_splits(term.name(), seed, SAMPLES, &whole, |cuts| evaluate(term, body, &recording, cuts))?;
    for invariant in term.invariants().iter() {
        check_invariant(term, body, invariant, seed, &recording, &whole)?;
    }
    Ok(())
}

/// The term's columns over a recording, row after row of its joints, evaluated in pieces that end at `cuts` with
/// the state carried over.
///
/// # Errors
/// [`Violation`] if the term fails, has another state than announced, or writes beyond its columns.
pub fn evaluate(
    term: &dyn ArmTerm,
    body: &dyn RigidBodyRegressor,
    recording: &Recording,
    cuts: &[usize],
) -> Result<Vec<Vec<f64>>, Violation> {
    let joints = recording.joints();
    let count = term.joints(joints).len() * term.columns(joints).len();
    let motion = recording.motion();
    let mut state = term.initial_state(&recording.arm(motion.view().slice(0..1), 0, body));
    if state.len() != term.state_len(joints) {
        let (announced, found) = (term.state_len(joints), state.len());
        return Err(broken(term, format!("announces {announced} state variables, has {found}")));
    }
    in_pieces(term.name(), count, recording.samples(), cuts, |piece, out| {
        let series = recording.arm(motion.view().slice(piece.clone()), piece.start, body);
        term.evaluate(&series, &mut state, out)
    })
}

/// Checks the shape parameters of a term.
///
/// # Errors
/// The first [`Violation`] that is found.
#[expect(clippy::borrowed_box, reason = "the box is cloned, which a bare trait object cannot be")]
pub fn check_shape(
    term: &Box<dyn ArmTerm>,
    body: &dyn RigidBodyRegressor,
    seed: u64,
) -> Result<(), Violation> {
    let recording = Recording::random(seed, body.joints(), SAMPLES);
    super::check_shape(
        term,
        term.name(),
        |t| t.shape_parameters(),
        |values| {
            let mut moved = term.clone();
            moved.set_shape(values)?;
            Ok(moved)
        },
        |t| evaluate(&**t, body, &recording, &[]),
    )
}

fn broken(term: &dyn ArmTerm, detail: String) -> Violation {
    Violation::Contract { model: term.name().into(), detail }
}

fn check_columns(
    term: &dyn ArmTerm,
    body: &dyn RigidBodyRegressor,
    whole: &[Vec<f64>],
) -> Result<(), Violation> {
    let joints = body.joints();
    let (rows, parameters) = (term.joints(joints), term.columns(joints));
    if !rows.is_sorted_by(|a, b| a < b) || rows.iter().any(|j| *j >= joints) {
        return Err(broken(term, format!("its joints {rows:?} do not ascend below {joints}")));
    }
    for (k, p) in parameters.iter().enumerate() {
        if p.name.is_empty() || p.unit.is_empty() || parameters[..k].iter().any(|o| o.name == p.name) {
            return Err(broken(term, format!("column {k} needs a name of its own and a unit, has {p:?}")));
        }
        for (i, joint) in rows.iter().enumerate() {
            let column = &whole[i * parameters.len() + k];
            if let Some(n) = column.iter().position(|x| !x.is_finite()) {
                return Err(broken(term, format!("`{}`, joint {joint}, sample {n}: {}", p.name, column[n])));
            }
            if !term.acts_on(k, *joint, joints) && column.iter().any(|x| *x != 0.0) {
                return Err(broken(term, format!("`{}` acts on joint {joint} unannounced", p.name)));
            }
        }
    }
    Ok(())
}

fn check_invariant(
    term: &dyn ArmTerm,
    body: &dyn RigidBodyRegressor,
    invariant: Invariant,
    seed: u64,
    recording: &Recording,
    whole: &[Vec<f64>],
) -> Result<(), Violation> {
    let joints = recording.joints();
    let (rows, count) = (term.joints(joints), term.columns(joints).len());
    let over = |recording: &Recording| evaluate(term, body, recording, &[]);
    let any = |is: &dyn Fn(usize, usize, f64) -> bool| {
        whole.iter().enumerate().find_map(|(c, column)| {
            let n = (0..column.len()).find(|n| is(rows[c / count], *n, column[*n]))?;
            Some(format!("column {}, joint {}, sample {n}: {}", c % count, rows[c / count], column[n]))
        })
    };
    let detail = match invariant {
        Invariant::Positive => any(&|_, _, x| x < 0.0),
        Invariant::BoundedByOne => any(&|_, _, x| x.abs() > 1.0),
        Invariant::SignOfVelocity => any(&|joint, n, x| x * recording.joint(joint).velocity_rad_s[n] < 0.0),
        Invariant::Passive => {
            let mut found = None;
            for amplitude in [1e-4, 1e-2, 1.0] {
                let closed = Recording::closed(seed, joints, 8_001, 2, amplitude, 1.3);
                let columns = over(&closed)?;
                for k in 0..count {
                    let (total, turnover) = rows.iter().enumerate().fold((0.0, 0.0), |sum, (i, joint)| {
                        let part = work(&columns[i * count + k], closed.joint(*joint).position_rad);
                        (sum.0 + part.0, sum.1 + part.1)
                    });
                    if total < -1e-6 * turnover {
                        found = Some(format!(
                            "column {k} does the work {total:e} over a cycle of {amplitude} rad"
                        ));
                    }
                }
            }
            found
        }
        Invariant::Memoryless => {
            let motion = recording.motion();
            let mut draw = Draw::new(seed);
            let mut found = None;
            for _ in 0..20 {
                let n = draw.below(recording.samples());
                let series = recording.arm(motion.view().slice(n..n + 1), n, body);
                let mut state = term.initial_state(&series);
                let mut alone = vec![0.0; whole.len()];
                term.evaluate(&series, &mut state, &mut Columns::new(&mut alone, whole.len(), 1, 1))
                    .map_err(|source| Violation::Failed { during: "evaluation", source })?;
                let same: Vec<Vec<f64>> = whole.iter().map(|c| vec![c[n]]).collect();
                let alone: Vec<Vec<f64>> = alone.into_iter().map(|x| vec![x]).collect();
                found = found.or_else(|| first_difference(&same, &alone, AGREEMENT));
            }
            found
        }
        other => of_motion(other, term.invariants(), seed, recording, whole, &over)?,
    };
    detail.map_or(Ok(()), |detail| Err(Violation::Invariant { model: term.name().into(), invariant, detail }))
}
