//! Arm terms of which each joint has columns of its own.

use aurt_traits::{ArmTerm, JointStack};
use serde_json::Value as Json;

use super::description::{described, number, unknown};
use super::friction::{self, At, decay};
use super::memory::Memory;
use super::tape::{Function, Tape, Value, ZERO};
use crate::ExportError;

#[derive(Debug, Clone, Copy)]
pub(crate) struct Coordinates {
    pub position: Value,
    pub velocity: Value,
    pub acceleration: Value,
}

const KNOWN: &str = "coulomb_asymmetric, coupling, current_offset, joint_friction, lugre_damped, payload, rotor_inertia, \
                     spring, temperature, viscous_asymmetric";

pub(crate) struct Writer<'a> {
    pub tape: &'a mut Tape,
    pub memory: &'a mut Memory,
    /// Number of joints of the robot.
    pub joints: usize,
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct Joint {
    pub number: usize,
    pub at: Coordinates,
    /// Load torque of friction there.
    pub load: Value,
}

impl Writer<'_> {
    /// Writes the torque of a term at one of its joints, with that joint's coefficients.
    ///
    /// # Errors
    /// [`ExportError::Model`] for a term that cannot be written, by its name.
    pub fn torque(
        &mut self,
        term: &dyn ArmTerm,
        joint: Joint,
        coefficients: &[Value],
    ) -> Result<Value, ExportError> {
        if term.name() == "joint_friction" {
            let stack = inner_stack(term)?;
            let at = At { velocity: joint.at.velocity, load: joint.load };
            return friction::torque(self.tape, self.memory, joint.number, &stack, coefficients, at);
        }
        let mut sum = Value::Constant(0.0);
        for (column, coefficient) in self.columns(term, joint)?.into_iter().zip(coefficients) {
            let product = self.tape.multiply(*coefficient, column);
            sum = self.tape.add(sum, product);
        }
        Ok(sum)
    }

    fn columns(&mut self, term: &dyn ArmTerm, joint: Joint) -> Result<Vec<Value>, ExportError> {
        let Joint { number: place_of, at, .. } = joint;
        let (tape, place) = (&mut *self.tape, "arm term".to_owned());
        match term.name() {
            "rotor_inertia" => Ok(vec![at.acceleration]),
            "current_offset" => Ok(vec![Value::Constant(1.0)]),
            "spring" => {
                let description = described(serde_json::to_value(term), place)?;
                let rest = description.get("rest_rad").and_then(Json::as_f64);
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
            "temperature" => {
                let description = described(serde_json::to_value(term), place.clone())?;
                let warming_time = number(&description, "warming_time_s", &place)?;
                let warmth = self.memory.warmth(tape, place_of, warming_time);
                let sign = tape.call(Function::SignBeyond, &[at.velocity, ZERO]);
                Ok([sign, at.velocity]
                    .into_iter()
                    .zip(warmth.into_iter().cycle())
                    .map(|(a, b)| tape.multiply(a, b))
                    .collect())
            }
            name @ "lugre_damped" => {
                let description = described(serde_json::to_value(term), place.clone())?;
                let remembered = self.memory.columns(tape, place_of, (name, &description, &place))?;
                let Some(force) = remembered.and_then(|columns| columns.first().copied()) else {
                    return Err(unknown(place, name, term.state_len(self.joints), KNOWN));
                };
                // The bristles' velocity ż = q̇ − |q̇| H/g(q̇), g = r + (1 − r) e^(−|q̇/v_S|^δ).
                let ratio = number(&description, "coulomb_ratio", &place)?;
                let falling = decay(tape, &description, at.velocity, &place)?;
                let beyond = tape.multiply(Value::Constant(1.0 - ratio), falling);
                let level = tape.add(Value::Constant(ratio), beyond);
                let speed = tape.call(Function::Abs, &[at.velocity]);
                let held = tape.multiply(speed, force);
                let share = tape.quotient(held, level);
                Ok(vec![force, tape.subtract(at.velocity, share)])
            }
            name => Err(unknown(place, name, term.state_len(self.joints), KNOWN)),
        }
    }
}

/// Adds the torque of the term `coupling`, of a motor that turns with ω = q̇_j + ratio q̇_k, to its two joints.
pub(crate) fn couple(
    tape: &mut Tape,
    term: &dyn ArmTerm,
    coefficients: &[Value],
    at: &[Coordinates],
    torque: &mut [Value],
) -> Result<(), ExportError> {
    let place = "arm term";
    let description = described(serde_json::to_value(term), place.to_owned())?;
    let [joint, partner] = [number(&description, "joint", place)?, number(&description, "partner", place)?];
    let (joint, partner) = (joint as usize, partner as usize);
    let ratio = Value::Constant(number(&description, "ratio", place)?);
    let rest = Value::Constant(number(&description, "rest_velocity_rad_s", place)?);
    let mut motor = |own: Value, other: Value| {
        let geared = tape.multiply(ratio, other);
        tape.add(own, geared)
    };
    let acceleration = motor(at[joint].acceleration, at[partner].acceleration);
    let velocity = motor(at[joint].velocity, at[partner].velocity);
    let sign = tape.call(Function::SignBeyond, &[velocity, rest]);
    let parts = [("inertia", acceleration), ("viscous", velocity), ("coulomb", sign)];
    let wanted = parts.iter().filter(|(key, _)| description.get(key).and_then(Json::as_bool) != Some(false));
    let mut force = ZERO;
    for ((_, column), coefficient) in wanted.zip(coefficients) {
        let part = tape.multiply(*coefficient, *column);
        force = tape.add(force, part);
    }
    let geared = tape.multiply(ratio, force);
    torque[joint] = tape.add(torque[joint], force);
    torque[partner] = tape.add(torque[partner], geared);
    Ok(())
}

fn inner_stack(term: &dyn ArmTerm) -> Result<JointStack, ExportError> {
    let mut copy = term.boxed_clone();
    let stack = copy.inner_models().map(|inner| {
        JointStack::new(
            inner.coulomb.boxed_clone(),
            inner.hysteresis.boxed_clone(),
            inner.viscous.boxed_clone(),
        )
    });
    match stack {
        Some(Ok(stack)) => Ok(stack),
        _ => Err(ExportError::Model {
            place: "arm term".into(),
            model: term.name().into(),
            reason: "its models do not fit equation (6)",
            known: KNOWN.into(),
        }),
    }
}

/// max(x, 0) and min(x, 0); halves of sums with |x| are exact.
fn parts(tape: &mut Tape, x: Value) -> Vec<Value> {
    let size = tape.call(Function::Abs, &[x]);
    let half = Value::Constant(0.5);
    let (plus, minus) = (tape.add(x, size), tape.subtract(x, size));
    vec![tape.multiply(half, plus), tape.multiply(half, minus)]
}
