//! Friction with memory: what it keeps from step to step, and its laws in C.

use std::fmt::Write;

use serde_json::Value as Json;

use super::{
    friction::number,
    tape::{Tape, Value, literal},
};
use crate::ExportError;

/// A law of `aurt-friction` with its shape parameters, by the equations of that crate.
#[derive(Debug, Clone, PartialEq)]
enum Law {
    Dahl { presliding: f64 },
    LuGre { presliding: f64, curve: [f64; 3] },
    BoucWen { presliding: f64, exponent: f64, beta: f64 },
    MaxwellSlip { thresholds: Vec<f64> },
    Gms { thresholds: Vec<f64>, curve: [f64; 3], attraction: f64 },
}

/// A law at a joint: its variables begin at `state`, its columns at `column`.
#[derive(Debug, Clone, PartialEq)]
struct Element {
    joint: usize,
    law: Law,
    state: usize,
    column: usize,
}

/// All friction with memory of a model.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Memory {
    elements: Vec<Element>,
    variables: usize,
    columns: usize,
}

/// The models of hysteresis with memory that can be written.
pub(crate) const KNOWN: [&str; 5] = ["bouc_wen", "dahl", "gms", "lugre", "maxwell_slip"];

impl Memory {
    /// Whether nothing is remembered.
    pub fn is_empty(&self) -> bool {
        self.elements.is_empty()
    }

    /// Number of variables in the state.
    pub const fn variables(&self) -> usize {
        self.variables
    }

    /// The columns of the model `name` at a joint; nothing for a name that is not in [`KNOWN`].
    ///
    /// # Errors
    /// [`ExportError::Model`] if the description lacks a parameter.
    pub fn columns(
        &mut self,
        tape: &mut Tape,
        joint: usize,
        (name, description, place): (&str, &Json, &str),
    ) -> Result<Option<Vec<Value>>, ExportError> {
        let number = |key| number(description, key, place);
        let curve = || {
            Ok::<_, ExportError>([
                number("stribeck_velocity_rad_s")?,
                number("coulomb_ratio")?,
                number("stribeck_exponent")?,
            ])
        };
        let law = match name {
            "dahl" => Law::Dahl { presliding: number("presliding_rad")? },
            "lugre" | "lugre_damped" => Law::LuGre { presliding: number("presliding_rad")?, curve: curve()? },
            "bouc_wen" => Law::BoucWen {
                presliding: number("presliding_rad")?,
                exponent: number("exponent")?,
                beta: number("beta")?,
            },
            "maxwell_slip" => Law::MaxwellSlip { thresholds: thresholds(description) },
            "gms" => Law::Gms {
                thresholds: thresholds(description),
                curve: curve()?,
                attraction: number("attraction_per_s")?,
            },
            _ => return Ok(None),
        };
        let (variables, columns) = law.sizes();
        let (state, column) = (self.variables, self.columns);
        self.elements.push(Element { joint, law, state, column });
        self.variables += variables;
        self.columns += columns;
        Ok(Some((column..self.columns).map(|k| tape.input(format!("h[{k}]"))).collect()))
    }

    /// The functions and tables that the laws need, at file scope.
    pub fn definitions(&self) -> String {
        let mut text = String::new();
        let mut written: Vec<&str> = Vec::new();
        for code in self.elements.iter().flat_map(|e| e.law.functions()) {
            if !written.contains(code) {
                text.push_str(code);
                written.push(code);
            }
        }
        for element in &self.elements {
            if let Law::MaxwellSlip { thresholds } | Law::Gms { thresholds, .. } = &element.law {
                let values: Vec<String> = thresholds.iter().map(|t| literal(*t)).collect();
                let _ = write!(
                    text,
                    "\nstatic const double thresholds_{}[{}] = {{{}}};\n",
                    element.column,
                    values.len(),
                    values.join(", ")
                );
            }
        }
        text
    }

    /// The statements that begin a series at its first sample and move the memory on to the present one.
    pub fn statements(&self) -> String {
        let mut text = String::new();
        if self.elements.is_empty() {
            return "    (void)t;\n    state->started = 1;\n".into();
        }
        let _ = writeln!(text, "    double h[{}];", self.columns);
        text.push_str("    if (state->started == 0) {\n");
        for element in &self.elements {
            for variable in element.law.positions() {
                let place = element.state + variable;
                let _ = writeln!(text, "        state->m[{place}] = q[{}];", element.joint);
            }
            if let Some(variable) = element.law.time() {
                let _ = writeln!(text, "        state->m[{}] = t;", element.state + variable);
            }
        }
        text.push_str("        state->started = 1;\n    }\n");
        for element in &self.elements {
            let _ = writeln!(text, "    {};", element.call());
        }
        if !text.contains("= t;") {
            text.push_str("    (void)t;\n");
        }
        text
    }
}

impl Element {
    fn call(&self) -> String {
        let Self { joint, law, state, column } = self;
        let memory = format!("&state->m[{state}]");
        let sample = format!("t, q[{joint}], qd[{joint}]");
        let numbers = |values: &[f64]| values.iter().map(|v| literal(*v)).collect::<Vec<String>>().join(", ");
        match law {
            Law::Dahl { presliding } => {
                format!("h[{column}] = dahl({memory}, q[{joint}], {})", literal(*presliding))
            }
            Law::LuGre { presliding, curve } => format!(
                "h[{column}] = lugre({memory}, {sample}, {}, {})",
                literal(*presliding),
                numbers(curve)
            ),
            Law::BoucWen { presliding, exponent, beta } => format!(
                "h[{column}] = bouc_wen({memory}, q[{joint}], {})",
                numbers(&[*presliding, *exponent, *beta])
            ),
            Law::MaxwellSlip { thresholds } => format!(
                "maxwell_slip({memory}, q[{joint}], thresholds_{column}, {}, &h[{column}])",
                thresholds.len()
            ),
            Law::Gms { thresholds, curve, attraction } => format!(
                "gms({memory}, {sample}, thresholds_{column}, {}, {}, {}, &h[{column}])",
                thresholds.len(),
                numbers(curve),
                literal(*attraction)
            ),
        }
    }
}

impl Law {
    /// Numbers of variables and columns.
    const fn sizes(&self) -> (usize, usize) {
        match self {
            Self::Dahl { .. } | Self::BoucWen { .. } => (2, 1),
            Self::LuGre { .. } => (3, 1),
            Self::MaxwellSlip { thresholds } => (thresholds.len(), thresholds.len()),
            Self::Gms { thresholds, .. } => (2 + 2 * thresholds.len(), thresholds.len()),
        }
    }

    /// The variables that begin as the first position of a series; all others begin as zero.
    fn positions(&self) -> std::ops::Range<usize> {
        match self {
            Self::Dahl { .. } | Self::BoucWen { .. } | Self::Gms { .. } => 1..2,
            Self::LuGre { .. } => 2..3,
            Self::MaxwellSlip { thresholds } => 0..thresholds.len(),
        }
    }

    /// The variable that holds the previous sample's time.
    const fn time(&self) -> Option<usize> {
        match self {
            Self::LuGre { .. } => Some(1),
            Self::Gms { .. } => Some(0),
            _ => None,
        }
    }

    /// The texts of the functions that the law needs, in order.
    const fn functions(&self) -> &'static [&'static str] {
        match self {
            Self::Dahl { .. } => &[RELAX, DAHL],
            Self::LuGre { .. } => &[RELAX, LEVEL, MEAN_VELOCITY, LUGRE],
            Self::BoucWen { .. } => &[BOUC_WEN],
            Self::MaxwellSlip { .. } => &[MAXWELL_SLIP],
            Self::Gms { .. } => &[LEVEL, MEAN_VELOCITY, GMS],
        }
    }
}

/// The thresholds of a description: its list, or the logarithmic grid with the defaults of `maxwell_slip` and `gms`.
fn thresholds(description: &Json) -> Vec<f64> {
    if let Some(list) = description.get("thresholds_rad").and_then(Json::as_array) {
        return list.iter().filter_map(Json::as_f64).collect();
    }
    let given = |key: &str, otherwise: f64| description.get(key).and_then(Json::as_f64).unwrap_or(otherwise);
    let (smallest, largest) = (given("smallest_rad", 0.0005), given("largest_rad", 0.12));
    let elements = description.get("elements").and_then(Json::as_u64).unwrap_or(5);
    let last = elements.saturating_sub(1).max(1) as f64;
    (0..elements).map(|i| smallest * (largest / smallest).powf(i as f64 / last)).collect()
}

const RELAX: &str = include_str!("laws/relax.c");
const DAHL: &str = include_str!("laws/dahl.c");
const LEVEL: &str = include_str!("laws/level.c");
const MEAN_VELOCITY: &str = include_str!("laws/mean_velocity.c");
const LUGRE: &str = include_str!("laws/lugre.c");
const BOUC_WEN: &str = include_str!("laws/bouc_wen.c");
const MAXWELL_SLIP: &str = include_str!("laws/maxwell_slip.c");
const GMS: &str = include_str!("laws/gms.c");
