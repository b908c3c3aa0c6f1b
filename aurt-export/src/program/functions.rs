//! The functions of an export as straight-line programs.

use aurt_rbd::{INERTIAL_PARAMETERS, SerialChain};
use aurt_traits::{ColumnGroup, LoadTorque};

use super::arm_terms::{Coordinates, Joint, Writer, couple};
use super::friction::{self, At};
use super::language::Language;
use super::memory::Memory;
use super::newton_euler::{Posture, Vector};
use super::tape::{Operations, Tape, Value, ZERO};
use super::tunable::Tunable;
use crate::{ExportError, Source};

#[derive(Debug, Clone)]
pub(crate) struct Function {
    /// Its name, without the robot's.
    pub name: &'static str,
    /// What it gives, as its comment says.
    pub summary: &'static str,
    /// Whether it takes the state and the time of a sample.
    pub steps: bool,
    /// Number of parameters that it takes.
    pub parameters: Option<usize>,
    /// Its arguments of one value a joint.
    pub arguments: &'static [&'static str],
    /// Its result and that result's length.
    pub result: (&'static str, usize),
    /// What it does, after the memory has moved on to the sample.
    pub body: Body,
    /// What that costs, functions that it calls aside.
    pub operations: Operations,
}

#[derive(Debug, Clone)]
pub(crate) enum Body {
    /// A line of operations with its results.
    Line(Tape, Vec<Value>),
    /// What the function `torque` does.
    Torque,
}

impl Function {
    /// The statements of a line; none for [`Body::Torque`].
    pub fn statements(&self, language: Language) -> String {
        let Body::Line(tape, results) = &self.body else { return String::new() };
        let targets: Vec<String> = (0..results.len()).map(|k| format!("{}[{k}]", self.result.0)).collect();
        tape.statements(language, &targets, results)
    }
}

const MOTION: &[&str] = &["q", "qd", "qdd"];

#[derive(Debug, Clone)]
pub(crate) struct Program {
    pub functions: Vec<Function>,
    pub memory: Memory,
}

impl Program {
    /// What each function costs; `prefix` stands before their names.
    pub fn costs(&self, prefix: &str) -> Vec<String> {
        let priced = self.functions.iter().filter(|f| f.operations != Operations::default());
        priced.map(|f| format!("{prefix}{}: {}", f.name, f.operations)).collect()
    }
}

/// Values of a function.
type Results = fn(&mut Parts<'_>) -> Result<Vec<Value>, ExportError>;

/// All functions of a model, its constants folded.
pub(crate) fn all(source: &Source<'_>, chain: &SerialChain) -> Result<Program, ExportError> {
    let (step, memory) = step(source, chain, None)?;
    let of = |name, summary, arguments, result, results: Results| {
        let mut parts = Parts::new(source, chain, None)?;
        let results = results(&mut parts)?;
        Ok::<_, ExportError>(parts.function(name, summary, arguments, result, results))
    };
    let rigid_body = of(
        "rigid_body_torque",
        "Torque of bodies and rotors alone: M(q) qdd + c(q, qd) + g(q).",
        MOTION,
        "tau",
        |parts| parts.bodies_and_rotors(),
    )?;
    let posture = &MOTION[..1];
    let of_bodies = [
        of("gravity", "Torque of the bodies' weight, g(q).", posture, "tau", |parts| parts.weight())?,
        of("mass_matrix", "Mass matrix M(q) of bodies and rotors, row after row.", posture, "m", |parts| {
            parts.mass_matrix()
        })?,
        of(
            "regressor",
            "Columns of the base parameters of the bodies, row after row, a joint a row: their torque is Y(q, qd, qdd) \
             times the parameters.",
            MOTION,
            "y",
            |parts| parts.regressor(),
        )?,
    ];
    let mut functions = Vec::new();
    if memory.is_empty() {
        let torque = Function {
            name: "torque",
            summary: "Torque of the drives, as `aurt predict` gives it: bodies, rotors, friction and all else.",
            steps: false,
            ..step.clone()
        };
        let friction = of(
            "friction_torque",
            "Torque of everything else: friction at the load of this motion, springs, offsets.",
            MOTION,
            "tau",
            |parts| parts.rest(),
        )?;
        let step = Function { body: Body::Torque, operations: Operations::default(), ..step };
        functions.extend([torque, rigid_body, friction]);
        functions.extend(of_bodies);
        functions.push(step);
    } else {
        functions.extend([step, rigid_body]);
        functions.extend(of_bodies);
    }
    Ok(Program { functions, memory })
}

/// The step of a model alone, whose coefficients of friction and arm terms are arguments.
pub(crate) fn tunable_step(
    source: &Source<'_>,
    chain: &SerialChain,
    tunable: &Tunable,
) -> Result<Program, ExportError> {
    let (step, memory) = step(source, chain, Some(tunable))?;
    Ok(Program { functions: vec![step], memory })
}

/// The step function, with the statements of the torque alone, and what is remembered.
fn step(
    source: &Source<'_>,
    chain: &SerialChain,
    tunable: Option<&Tunable>,
) -> Result<(Function, Memory), ExportError> {
    let mut parts = Parts::new(source, chain, tunable)?;
    let (mut sum, rest) = (parts.bodies_and_rotors()?, parts.rest()?);
    for (s, r) in sum.iter_mut().zip(rest) {
        *s = parts.tape.add(*s, r);
    }
    let summary = "Torque of the drives at time t, s, as `aurt predict` gives it for the samples of a series, one after \
                   another.";
    let memory = std::mem::take(&mut parts.memory);
    let made = parts.function("step", summary, MOTION, "tau", sum);
    let parameters = tunable.map(|t| t.parameters().len());
    Ok((Function { steps: true, parameters, ..made }, memory))
}

/// The parts of the torque of a motion on one tape, so that they share what they have in common.
struct Parts<'a> {
    tape: Tape,
    memory: Memory,
    source: &'a Source<'a>,
    chain: &'a SerialChain,
    posture: Posture,
    coordinates: Vec<Coordinates>,
    /// The model's coefficients.
    values: Vec<Value>,
    gravity: Vector,
    /// Standard parameters of a body that the last link carries, where it can be chosen.
    carried: Vec<Value>,
}

impl<'a> Parts<'a> {
    fn new(
        source: &'a Source<'a>,
        chain: &'a SerialChain,
        tunable: Option<&Tunable>,
    ) -> Result<Self, ExportError> {
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
        let constants = source.coefficients.iter().map(|c| Value::Constant(*c)).collect();
        let (values, gravity, carried) = match tunable {
            None => (constants, chain.gravity_m_s2().map(Value::Constant), Vec::new()),
            Some(tunable) => {
                (tunable.coefficients(&mut tape), tunable.gravity(&mut tape), tunable.carried(&mut tape))
            }
        };
        let memory = Memory::default();
        Ok(Self { tape, memory, source, chain, posture, coordinates, values, gravity, carried })
    }

    /// The torque of bodies whose coefficients are `weights`; the load on the last link counts.
    fn bodies(&mut self, weights: &[Value], carries: bool) -> Result<Vec<Value>, ExportError> {
        let velocities: Vec<Value> = self.coordinates.iter().map(|c| c.velocity).collect();
        let accelerations: Vec<Value> = self.coordinates.iter().map(|c| c.acceleration).collect();
        let mut standard = vec![ZERO; INERTIAL_PARAMETERS * self.chain.joints().len()];
        for (coefficient, place) in self.source.places()? {
            standard[place] = self.tape.add(standard[place], weights[coefficient]);
        }
        if carries && !self.carried.is_empty() {
            let last = standard.len() - INERTIAL_PARAMETERS;
            for (own, more) in standard[last..].iter_mut().zip(&self.carried) {
                *own = self.tape.add(*own, *more);
            }
        }
        Ok(self.posture.torque(&mut self.tape, &standard, self.gravity, &velocities, &accelerations))
    }

    fn bodies_and_rotors(&mut self) -> Result<Vec<Value>, ExportError> {
        let values = self.values.clone();
        let mut torque = self.bodies(&values, true)?;
        let none = vec![ZERO; torque.len()];
        self.add_terms(&mut torque, &values, &none, |term| term.name() == "rotor_inertia")?;
        Ok(torque)
    }

    /// What is neither body nor rotor.
    fn rest(&mut self) -> Result<Vec<Value>, ExportError> {
        let Source { model, coefficients, load, .. } = *self.source;
        let (values, none) = (self.values.clone(), vec![ZERO; model.joints()]);
        let load_torque = match load {
            LoadTorque::Literal => {
                let base = model.base().len();
                let ones: Vec<Value> =
                    (0..values.len()).map(|k| Value::Constant(if k < base { 1.0 } else { 0.0 })).collect();
                self.bodies(&ones, false)?
            }
            LoadTorque::Fitted(weights) => {
                // Weights that are the coefficients follow these where they can be chosen.
                let weights: Vec<Value> = (weights.iter().zip(coefficients).zip(&values))
                    .map(|((w, c), value)| if w == c { *value } else { Value::Constant(*w) })
                    .collect();
                let mut torque = self.bodies(&weights, true)?;
                self.add_terms(&mut torque, &weights, &none, |term| term.is_load())?;
                torque
            }
        };
        let mut torque = none;
        self.add_terms(&mut torque, &values, &load_torque, |term| term.name() != "rotor_inertia")?;
        for (j, stack) in model.stacks().iter().enumerate() {
            let own = &values[model.group(ColumnGroup::JointDynamics(j))];
            let at = At { velocity: self.coordinates[j].velocity, load: load_torque[j] };
            let friction = friction::torque(&mut self.tape, &mut self.memory, j, stack, own, at)?;
            torque[j] = self.tape.add(torque[j], friction);
        }
        Ok(torque)
    }

    /// Adds arm terms other than `payload`, which is a part of the bodies.
    fn add_terms(
        &mut self,
        torque: &mut [Value],
        coefficients: &[Value],
        load: &[Value],
        which: impl Fn(&dyn aurt_traits::ArmTerm) -> bool,
    ) -> Result<(), ExportError> {
        let model = self.source.model;
        let wanted = |term: &dyn aurt_traits::ArmTerm| term.name() != "payload" && which(term);
        for (k, term) in model.arm_terms().iter().enumerate().filter(|(_, term)| wanted(&***term)) {
            let own = &coefficients[model.group(ColumnGroup::ArmTerm(k))];
            if term.name() == "coupling" {
                couple(&mut self.tape, &**term, own, &self.coordinates, torque)?;
                continue;
            }
            let acting = term.joints(model.joints());
            let per_joint = own.len() / acting.len().max(1);
            for (joint, own) in acting.iter().zip(own.chunks(per_joint.max(1))) {
                let mut writer =
                    Writer { tape: &mut self.tape, memory: &mut self.memory, joints: model.joints() };
                let place = Joint { number: *joint, at: self.coordinates[*joint], load: load[*joint] };
                let acts = writer.torque(&**term, place, own)?;
                torque[*joint] = self.tape.add(torque[*joint], acts);
            }
        }
        Ok(())
    }

    fn constant_bodies(&self) -> Result<Vec<Value>, ExportError> {
        let coefficients = self.source.coefficients;
        Ok(self.source.bodies(|k| coefficients[k])?.into_iter().map(Value::Constant).collect())
    }

    fn weight(&mut self) -> Result<Vec<Value>, ExportError> {
        let rest = vec![ZERO; self.chain.joints().len()];
        let standard = self.constant_bodies()?;
        Ok(self.posture.torque(&mut self.tape, &standard, self.gravity, &rest, &rest))
    }

    fn mass_matrix(&mut self) -> Result<Vec<Value>, ExportError> {
        let joints = self.chain.joints().len();
        let standard = self.constant_bodies()?;
        let rest = vec![ZERO; joints];
        let mut entries = vec![ZERO; joints * joints];
        for (column, rotor) in self.source.rotor_inertia_kg_m2().into_iter().enumerate() {
            let mut unit = rest.clone();
            unit[column] = Value::Constant(1.0);
            let torque = self.posture.torque(&mut self.tape, &standard, [ZERO; 3], &rest, &unit);
            // The matrix is symmetric: what joints before the column's need is enough.
            for row in 0..=column {
                entries[row * joints + column] = torque[row];
                entries[column * joints + row] = torque[row];
            }
            let diagonal = column * joints + column;
            entries[diagonal] = self.tape.add(entries[diagonal], Value::Constant(rotor));
        }
        Ok(entries)
    }

    fn regressor(&mut self) -> Result<Vec<Value>, ExportError> {
        let columns = self.source.model.base().len();
        let mut entries = vec![ZERO; self.chain.joints().len() * columns];
        for column in 0..columns {
            let mut unit = vec![ZERO; self.values.len()];
            unit[column] = Value::Constant(1.0);
            for (joint, torque) in self.bodies(&unit, false)?.into_iter().enumerate() {
                entries[joint * columns + column] = torque;
            }
        }
        Ok(entries)
    }

    /// A function of these parts without state.
    fn function(
        self,
        name: &'static str,
        summary: &'static str,
        arguments: &'static [&'static str],
        result: &'static str,
        results: Vec<Value>,
    ) -> Function {
        Function {
            name,
            summary,
            steps: false,
            parameters: None,
            arguments,
            result: (result, results.len()),
            operations: self.tape.operations(&results),
            body: Body::Line(self.tape, results),
        }
    }
}
