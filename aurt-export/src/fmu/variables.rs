//! The variables of a unit, in the order of their value references.

use std::fmt::Write;

use aurt_rbd::{JointKind, SerialChain};
use aurt_traits::MeasurementUnit;

use super::Kind;
use crate::naming::joint_names;
use crate::program::{Tunable, literal};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    Time,
    Input,
    /// An input that jumps from step to step.
    Jumping,
    Output,
    Tunable,
    /// A parameter that is fixed once initialisation is over.
    Fixed,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Variable {
    pub name: String,
    pub role: Role,
    pub unit: String,
    pub description: String,
    pub start: f64,
}

/// All variables and where each group of them begins.
#[derive(Debug, Clone)]
pub(super) struct Variables {
    pub all: Vec<Variable>,
    joints: usize,
    places: Vec<(&'static str, usize)>,
}

/// The longest step of the integration, s, as in `aurt simulate`.
const LONGEST_STEP_S: f64 = 1e-3;

impl Variables {
    pub fn new(kind: Kind, unit: MeasurementUnit, chain: &SerialChain, tunable: &Tunable) -> Self {
        let mut made = Self { all: Vec::new(), joints: chain.joints().len(), places: Vec::new() };
        made.one("time", Role::Time, "s", "time", 0.0);
        let (word, newton_metre, newton) = match unit {
            MeasurementUnit::Ampere => ("current", "A", "A"),
            MeasurementUnit::NewtonMetre => ("tau", "N.m", "N"),
        };
        let rate = format!("{word}_rate");
        let (motion, effort) = match kind {
            Kind::Inverse => (Role::Input, Role::Output),
            Kind::Forward => (Role::Output, Role::Input),
        };
        let [q, qd, qdd] = [
            ("OF_Q", "q", ["rad", "m"], "position"),
            ("OF_QD", "dq", ["rad/s", "m/s"], "velocity"),
            ("OF_QDD", "ddq", ["rad/s2", "m/s2"], "acceleration"),
        ];
        let drives = ("OF_TAU", word, [newton_metre, newton], "drive");
        match kind {
            Kind::Inverse => {
                for group in [q, qd, qdd] {
                    made.group(chain, group, motion);
                }
                made.group(chain, drives, effort);
            }
            Kind::Forward => {
                made.group(chain, drives, effort);
                let units = [&format!("{newton_metre}/s"), &format!("{newton}/s")];
                let what = "rate at which the drive changes during a step; 0: it stays";
                made.group(chain, ("OF_TAU_RATE", &rate, units.map(String::as_str), what), Role::Jumping);
                for group in [q, qd, qdd] {
                    made.group(chain, group, motion);
                }
                made.group(chain, ("OF_Q_START", "q_start", q.2, "position at the start"), Role::Fixed);
                made.group(chain, ("OF_QD_START", "dq_start", qd.2, "velocity at the start"), Role::Fixed);
                made.places.push(("OF_MAX_STEP", made.all.len()));
                let what = "longest step of the integration within a communication step";
                made.one("max_step_s", Role::Fixed, "s", what, LONGEST_STEP_S);
            }
        }
        made.places.push(("OF_P", made.all.len()));
        for p in tunable.parameters() {
            made.one(&p.name, Role::Tunable, &p.unit, &p.description, p.start);
        }
        made
    }

    fn one(&mut self, name: &str, role: Role, unit: &str, description: &str, start: f64) {
        let [name, unit, description] = [name, unit, description].map(str::to_owned);
        self.all.push(Variable { name, role, unit, description, start });
    }

    /// A variable for each joint; units of revolute and of prismatic joints.
    fn group(
        &mut self,
        chain: &SerialChain,
        (place, name, units, what): (&'static str, &str, [&str; 2], &str),
        role: Role,
    ) {
        self.places.push((place, self.all.len()));
        // FMI forbids control characters in names.
        let names = joint_names(chain, |name| name.replace(|c: char| c.is_control(), " "), &[]);
        for (j, (joint, own)) in chain.joints().iter().zip(&names).enumerate() {
            let unit = units[usize::from(joint.kind == JointKind::Prismatic)];
            let own = if chain.joint_names().is_empty() { j.to_string() } else { own.clone() };
            self.one(&format!("{name}[{own}]"), role, unit, &format!("{what} of joint {j}"), 0.0);
        }
    }

    /// The header that tells the sources of every unit about this model.
    pub fn header(&self, name: &str, kind: Kind, token: &str) -> String {
        let mut text = format!(
            "/* The model of this unit, for the sources that every unit has. */\n#ifndef MODEL_H\n#define MODEL_H\n\n\
             #include \"{name}.h\"\n\n#define MODEL_JOINTS {}\n#define MODEL_MOVES {}\n#define MODEL_STATE {name}_state\n\
             #define MODEL_RESET {name}_reset\n#define MODEL_STEP {name}_step\n#define MODEL_TOKEN \"{token}\"\n\n\
             /* Value references: the first of each group. */\n#define VARIABLES {}\n",
            self.joints,
            u8::from(kind == Kind::Forward),
            self.all.len()
        );
        for (place, first) in &self.places {
            let _ = writeln!(text, "#define {place} {first}");
        }
        let settable = |role: Role| match role {
            Role::Time | Role::Output => "0",
            Role::Input | Role::Jumping | Role::Tunable => "1",
            Role::Fixed => "2",
        };
        let list = |values: Vec<String>| {
            let lines: Vec<String> = values.chunks(8).map(|line| line.join(", ")).collect();
            format!("{{ \\\n    {} }}", lines.join(", \\\n    "))
        };
        let kinds = list(self.all.iter().map(|v| settable(v.role).to_owned()).collect());
        let starts = list(self.all.iter().map(|v| literal(v.start)).collect());
        let _ = write!(text, "\n#define MODEL_SETTABLE {kinds}\n\n#define MODEL_START {starts}\n\n#endif\n");
        text
    }
}
