//! The functions of an export as straight-line programs.

use aurt_rbd::SerialChain;
use aurt_traits::{ColumnGroup, LoadTorque};

use super::{
    arm_terms::{self, Coordinates},
    friction::{self, At},
    newton_euler::Posture,
    tape::{Operations, Tape, Value, ZERO},
};
use crate::{ExportError, Source};

/// A function of the export.
#[derive(Debug, Clone)]
pub(crate) struct Function {
    /// Its name, without the robot's.
    pub name: &'static str,
    /// What it gives, as its comment says.
    pub summary: &'static str,
    /// Its arguments.
    pub arguments: &'static [&'static str],
    /// Its result and that result's length.
    pub result: (&'static str, usize),
    /// Its statements.
    pub body: String,
    /// What they cost.
    pub operations: Operations,
}

const MOTION: &[&str] = &["q", "qd", "qdd"];

/// All functions of a model.
///
/// # Errors
/// What cannot be written in C, by its name.
pub(crate) fn all(source: &Source<'_>, chain: &SerialChain) -> Result<Vec<Function>, ExportError> {
    let joints = chain.joints().len();
    Ok(vec![
        motion_function(
            source,
            chain,
            "torque",
            "Torque of the drives, as `aurt predict` gives it: bodies, rotors, friction and all else.",
            |parts| {
                let (mut sum, rest) = (parts.bodies_and_rotors()?, parts.rest()?);
                for (s, r) in sum.iter_mut().zip(rest) {
                    *s = parts.tape.add(*s, r);
                }
                Ok(sum)
            },
        )?,
        motion_function(
            source,
            chain,
            "rigid_body_torque",
            "Torque of bodies and rotors alone: M(q) qdd + c(q, qd) + g(q).",
            |parts| parts.bodies_and_rotors(),
        )?,
        motion_function(
            source,
            chain,
            "friction_torque",
            "Torque of everything else: friction at the load of this motion, springs, offsets.",
            |parts| parts.rest(),
        )?,
        gravity(source, chain)?,
        mass_matrix(source, chain, joints)?,
    ])
}

/// The parts of the torque of a motion on one tape, so that they share what they have in common.
struct Parts<'a> {
    tape: Tape,
    source: &'a Source<'a>,
    chain: &'a SerialChain,
    posture: Posture,
    coordinates: Vec<Coordinates>,
}

impl<'a> Parts<'a> {
    fn new(source: &'a Source<'a>, chain: &'a SerialChain) -> Result<Self, ExportError> {
        let joints = chain.joints().len();
        let mut tape = Tape::default();
        let coordinates: Vec<Coordinates> = (0..joints)
            .map(|j| Coordinates {
                position: tape.input(format!("q[{j}]")),
                velocity: tape.input(format!("qd[{j}]")),
                acceleration: tape.input(format!("qdd[{j}]")),
            })
            .collect();
        let positions: Vec<Value> = coordinates.iter().map(|c| c.position).collect();
        let posture = Posture::new(&mut tape, chain, &positions)?;
        Ok(Self { tape, source, chain, posture, coordinates })
    }

    /// The torque of bodies whose base parameters have the values that `weight` names.
    fn bodies(&mut self, weight: impl Fn(usize) -> f64) -> Vec<Value> {
        let velocities: Vec<Value> = self.coordinates.iter().map(|c| c.velocity).collect();
        let accelerations: Vec<Value> = self.coordinates.iter().map(|c| c.acceleration).collect();
        let (standard, gravity) = (self.source.bodies(weight), self.chain.gravity_m_s2());
        self.posture.torque(&mut self.tape, &standard, gravity, &velocities, &accelerations)
    }

    fn bodies_and_rotors(&mut self) -> Result<Vec<Value>, ExportError> {
        let coefficients = self.source.coefficients;
        let mut torque = self.bodies(|k| coefficients[k]);
        self.add_terms(&mut torque, coefficients, |term| term.name() == "rotor_inertia")?;
        Ok(torque)
    }

    /// What is neither body nor rotor.
    fn rest(&mut self) -> Result<Vec<Value>, ExportError> {
        let Source { model, coefficients, load, .. } = *self.source;
        let mut load_torque = match load {
            LoadTorque::Literal => self.bodies(|_| 1.0),
            LoadTorque::Fitted(weights) => {
                let mut torque = self.bodies(|k| weights[k]);
                self.add_terms(&mut torque, weights, |term| term.is_load())?;
                torque
            }
        };
        let mut torque = vec![ZERO; model.joints()];
        self.add_terms(&mut torque, coefficients, |term| term.name() != "rotor_inertia")?;
        for (j, stack) in model.stacks().iter().enumerate() {
            let own = &coefficients[model.group(ColumnGroup::JointDynamics(j))];
            let at = At {
                velocity: self.coordinates[j].velocity,
                load: std::mem::replace(&mut load_torque[j], ZERO),
            };
            let friction = friction::torque(&mut self.tape, j, stack, own, at)?;
            torque[j] = self.tape.add(torque[j], friction);
        }
        Ok(torque)
    }

    fn add_terms(
        &mut self,
        torque: &mut [Value],
        coefficients: &[f64],
        which: impl Fn(&dyn aurt_traits::ArmTerm) -> bool,
    ) -> Result<(), ExportError> {
        let model = self.source.model;
        for (k, term) in model.arm_terms().iter().enumerate().filter(|(_, term)| which(&***term)) {
            let own = &coefficients[model.group(ColumnGroup::ArmTerm(k))];
            let acting = term.joints(model.joints());
            let per_joint = own.len() / acting.len().max(1);
            for (joint, own) in acting.iter().zip(own.chunks(per_joint.max(1))) {
                let at = self.coordinates[*joint];
                let columns = arm_terms::columns(&mut self.tape, &**term, model.joints(), at)?;
                for (column, coefficient) in columns.into_iter().zip(own) {
                    let product = self.tape.multiply(Value::Constant(*coefficient), column);
                    torque[*joint] = self.tape.add(torque[*joint], product);
                }
            }
        }
        Ok(())
    }
}

fn motion_function(
    source: &Source<'_>,
    chain: &SerialChain,
    name: &'static str,
    summary: &'static str,
    results: impl FnOnce(&mut Parts<'_>) -> Result<Vec<Value>, ExportError>,
) -> Result<Function, ExportError> {
    let mut parts = Parts::new(source, chain)?;
    let results = results(&mut parts)?;
    Ok(function(name, summary, MOTION, "tau", &parts.tape, &results))
}

fn gravity(source: &Source<'_>, chain: &SerialChain) -> Result<Function, ExportError> {
    let joints = chain.joints().len();
    let mut tape = Tape::default();
    let q: Vec<Value> = (0..joints).map(|j| tape.input(format!("q[{j}]"))).collect();
    let posture = Posture::new(&mut tape, chain, &q)?;
    let rest = vec![ZERO; joints];
    let standard = source.bodies(|k| source.coefficients[k]);
    let torque = posture.torque(&mut tape, &standard, chain.gravity_m_s2(), &rest, &rest);
    let summary = "Torque of the bodies' weight, g(q).";
    Ok(function("gravity", summary, &MOTION[..1], "tau", &tape, &torque))
}

fn mass_matrix(source: &Source<'_>, chain: &SerialChain, joints: usize) -> Result<Function, ExportError> {
    let mut tape = Tape::default();
    let q: Vec<Value> = (0..joints).map(|j| tape.input(format!("q[{j}]"))).collect();
    let posture = Posture::new(&mut tape, chain, &q)?;
    let standard = source.bodies(|k| source.coefficients[k]);
    let rest = vec![ZERO; joints];
    let rotors = source.rotor_inertia_kg_m2();
    let mut entries = vec![ZERO; joints * joints];
    for column in 0..joints {
        let mut unit = rest.clone();
        unit[column] = Value::Constant(1.0);
        let torque = posture.torque(&mut tape, &standard, [0.0; 3], &rest, &unit);
        // The matrix is symmetric: what joints before the column's need is enough.
        for row in 0..=column {
            entries[row * joints + column] = torque[row];
            entries[column * joints + row] = torque[row];
        }
        let diagonal = column * joints + column;
        entries[diagonal] = tape.add(entries[diagonal], Value::Constant(rotors[column]));
    }
    let summary = "Mass matrix M(q) of bodies and rotors, row after row.";
    Ok(function("mass_matrix", summary, &MOTION[..1], "m", &tape, &entries))
}

fn function(
    name: &'static str,
    summary: &'static str,
    arguments: &'static [&'static str],
    result: &'static str,
    tape: &Tape,
    results: &[Value],
) -> Function {
    let targets: Vec<String> = (0..results.len()).map(|k| format!("{result}[{k}]")).collect();
    Function {
        name,
        summary,
        arguments,
        result: (result, results.len()),
        body: tape.statements(&targets, results),
        operations: tape.operations(results),
    }
}
