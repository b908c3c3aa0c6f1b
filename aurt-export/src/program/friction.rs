//! Equation (6) of a joint, τ_JD = f_C(τ_J)·H(z, q̇) + f_v(q̇).

use aurt_traits::JointStack;
use serde_json::Value as Json;

use super::description::{described, number, unknown};
use super::memory::{KNOWN, Memory};
use super::tape::{Function, Tape, Value};
use crate::ExportError;

#[derive(Debug, Clone, Copy)]
pub(crate) struct At {
    pub velocity: Value,
    pub load: Value,
}

/// Writes the friction of joint `joint` with its coefficients, in the stack's order.
pub(crate) fn torque(
    tape: &mut Tape,
    memory: &mut Memory,
    joint: usize,
    stack: &JointStack,
    coefficients: &[Value],
    at: At,
) -> Result<Value, ExportError> {
    let levels = coulomb(tape, joint, stack, at)?;
    // A level of no columns leaves nothing of the hysteresis, and nothing to remember.
    let shapes = if levels.is_empty() { Vec::new() } else { hysteresis(tape, memory, joint, stack, at)? };
    let (products, linear) = coefficients.split_at(levels.len() * shapes.len());
    let mut sum = Value::Constant(0.0);
    for (column, coefficient) in viscous(tape, joint, stack, at)?.into_iter().zip(linear) {
        let term = tape.multiply(*coefficient, column);
        sum = tape.add(sum, term);
    }
    for (level, row) in levels.iter().zip(products.chunks_exact(shapes.len().max(1))) {
        for (shape, coefficient) in shapes.iter().zip(row) {
            let height = tape.multiply(*coefficient, *level);
            let term = tape.multiply(height, *shape);
            sum = tape.add(sum, term);
        }
    }
    Ok(sum)
}

/// The columns of f_C.
fn coulomb(tape: &mut Tape, joint: usize, stack: &JointStack, at: At) -> Result<Vec<Value>, ExportError> {
    let place = || format!("joint {joint}, coulomb");
    let model = stack.coulomb();
    let description = described(serde_json::to_value(model), place())?;
    let one = Value::Constant(1.0);
    let load_power = |tape: &mut Tape, name: &str| match name {
        "absolute" => Some(tape.call(Function::Abs, &[at.load])),
        "square" => Some(tape.multiply(at.load, at.load)),
        _ => None,
    };
    match model.name() {
        "absent" => Ok(Vec::new()),
        "constant" => Ok(vec![one]),
        name @ ("absolute" | "square") => {
            Ok([Some(one), load_power(tape, name)].into_iter().flatten().collect())
        }
        "stribeck" => {
            let decay = decay(tape, &description, at.velocity, &place())?;
            let mut columns = vec![one, decay];
            let growth = description.get("load").and_then(Json::as_str).unwrap_or("none").to_owned();
            if let Some(level) = load_power(tape, &growth) {
                columns.extend([level, tape.multiply(level, decay)]);
            }
            let has_level = description.get("level").and_then(Json::as_bool).unwrap_or(true);
            Ok(columns
                .into_iter()
                .skip(usize::from(!has_level))
                .step_by(if has_level { 1 } else { 2 })
                .collect())
        }
        name => Err(unknown(place(), name, model.state_len(), "absent, none, absolute, square, stribeck")),
    }
}

/// e^(−|q̇/v_S|^δ), or 1/(1 + |q̇/v_S|^δ) of the rational law.
pub(crate) fn decay(
    tape: &mut Tape,
    description: &Json,
    velocity: Value,
    place: &str,
) -> Result<Value, ExportError> {
    let scale = number(description, "stribeck_velocity_rad_s", place)?;
    let exponent = number(description, "stribeck_exponent", place)?;
    let ratio = tape.divide(velocity, scale);
    let x = tape.call(Function::Abs, &[ratio]);
    let power = if exponent == 2.0 {
        tape.multiply(x, x)
    } else if exponent == 1.0 {
        x
    } else {
        tape.call(Function::Pow, &[x, Value::Constant(exponent)])
    };
    if description.get("law").is_some_and(|law| law == "rational") {
        let sum = tape.add(Value::Constant(1.0), power);
        return Ok(tape.call(Function::Pow, &[sum, Value::Constant(-1.0)]));
    }
    let minus = tape.negate(power);
    Ok(tape.call(Function::Exp, &[minus]))
}

fn hysteresis(
    tape: &mut Tape,
    memory: &mut Memory,
    joint: usize,
    stack: &JointStack,
    at: At,
) -> Result<Vec<Value>, ExportError> {
    let place = format!("joint {joint}, hysteresis");
    let model = stack.hysteresis();
    let description = described(serde_json::to_value(model), place.clone())?;
    match model.name() {
        "sign" => {
            let rest = number(&description, "rest_velocity_rad_s", &place)?;
            Ok(vec![tape.call(Function::SignBeyond, &[at.velocity, Value::Constant(rest)])])
        }
        "tanh" => {
            let ratio = tape.divide(at.velocity, number(&description, "velocity_rad_s", &place)?);
            Ok(vec![tape.call(Function::Tanh, &[ratio])])
        }
        name if name != "lugre_damped" => {
            let remembered = memory.columns(tape, joint, (name, &description, &place))?;
            let known = format!("{}, sign, tanh", KNOWN.join(", "));
            remembered.ok_or_else(|| unknown(place, name, model.state_len(), &known))
        }
        name => Err(unknown(place, name, model.state_len(), &KNOWN.join(", "))),
    }
}

/// The columns of f_v.
fn viscous(tape: &mut Tape, joint: usize, stack: &JointStack, at: At) -> Result<Vec<Value>, ExportError> {
    let place = format!("joint {joint}, viscous");
    let model = stack.viscous();
    let description = described(serde_json::to_value(model), place.clone())?;
    match model.name() {
        "polynomial" => {
            let powers = description.get("powers").and_then(Json::as_array).cloned().unwrap_or_default();
            Ok(powers
                .iter()
                .filter_map(Json::as_u64)
                .map(|power| odd_power(tape, at.velocity, power))
                .collect())
        }
        "power_law" => {
            let exponent = Value::Constant(number(&description, "exponent", &place)?);
            let speed = tape.call(Function::Abs, &[at.velocity]);
            let power = tape.call(Function::Pow, &[speed, exponent]);
            let sign = tape.call(Function::SignBeyond, &[at.velocity, Value::Constant(0.0)]);
            Ok(vec![tape.multiply(sign, power)])
        }
        "saturating" => {
            let ratio = tape.divide(at.velocity, number(&description, "saturation_velocity_rad_s", &place)?);
            let mut columns = vec![tape.call(Function::Tanh, &[ratio])];
            if description.get("linear").and_then(Json::as_bool) == Some(true) {
                columns.push(at.velocity);
            }
            Ok(columns)
        }
        name => Err(unknown(place, name, model.state_len(), "polynomial, power_law, saturating")),
    }
}

/// q̇ |q̇|^(power − 1).
fn odd_power(tape: &mut Tape, velocity: Value, power: u64) -> Value {
    let mut product = velocity;
    for _ in 1..power {
        let size = tape.call(Function::Abs, &[velocity]);
        product = tape.multiply(product, size);
    }
    product
}
