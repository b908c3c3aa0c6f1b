//! Arm terms of which each joint has columns of its own.

use aurt_traits::ArmTerm;

use super::{
    friction::{described, number, unknown},
    tape::{Function, Tape, Value},
};
use crate::ExportError;

/// Coordinates of a joint.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Coordinates {
    pub position: Value,
    pub velocity: Value,
    pub acceleration: Value,
}

/// The arm terms that can be written.
const KNOWN: &str = "coulomb_asymmetric, current_offset, rotor_inertia, spring, viscous_asymmetric";

/// Writes the columns of a term for one of its joints.
///
/// # Errors
/// [`ExportError::Model`] for a term that cannot be written, by its name.
pub(crate) fn columns(
    tape: &mut Tape,
    term: &dyn ArmTerm,
    joints: usize,
    at: Coordinates,
) -> Result<Vec<Value>, ExportError> {
    let place = "arm term".to_owned();
    match term.name() {
        "rotor_inertia" => Ok(vec![at.acceleration]),
        "current_offset" => Ok(vec![Value::Constant(1.0)]),
        "spring" => {
            let description = described(serde_json::to_value(term), place)?;
            let rest = description.get("rest_rad").and_then(serde_json::Value::as_f64);
            let turned = tape.subtract(at.position, Value::Constant(rest.unwrap_or(0.0)));
            let constant = rest.is_none().then_some(Value::Constant(-1.0));
            Ok([Some(turned), constant].into_iter().flatten().collect())
        }
        "viscous_asymmetric" => Ok(parts(tape, at.velocity)),
        "coulomb_asymmetric" => {
            let description = described(serde_json::to_value(term), place.clone())?;
            let rest = number(&description, "rest_velocity_rad_s", &place)?;
            let sign = tape.call(Function::SignBeyond, &[at.velocity, Value::Constant(rest)]);
            Ok(parts(tape, sign))
        }
        name => Err(unknown(place, name, term.state_len(joints), KNOWN)),
    }
}

/// max(x, 0) and min(x, 0); halves of sums with |x| are exact.
fn parts(tape: &mut Tape, x: Value) -> Vec<Value> {
    let size = tape.call(Function::Abs, &[x]);
    let half = Value::Constant(0.5);
    let (plus, minus) = (tape.add(x, size), tape.subtract(x, size));
    vec![tape.multiply(half, plus), tape.multiply(half, minus)]
}
