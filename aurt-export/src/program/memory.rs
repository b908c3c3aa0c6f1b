//! Friction with memory: what it keeps from step to step, and the calls of its laws.

use std::fmt::Write;

use serde_json::Value as Json;

use super::description::number;
use super::language::{Language, list, literal};
use super::tape::{Tape, Value};
use crate::ExportError;

/// A law of `aurt-friction` with its shape parameters, by the equations of that crate.
#[derive(Debug, Clone, PartialEq)]
enum Law {
    Dahl {
        presliding: f64,
    },
    LuGre {
        presliding: f64,
        curve: [f64; 3],
    },
    BoucWen {
        presliding: f64,
        exponent: f64,
        beta: f64,
    },
    MaxwellSlip {
        thresholds: Vec<f64>,
    },
    Gms {
        thresholds: Vec<f64>,
        curve: [f64; 3],
        attraction: f64,
    },
    /// ln(1 + t/T) with the time since the series began.
    Warmth {
        warming_time: f64,
    },
}

/// A law at a joint: its variables begin at `state`, its columns at `column`.
#[derive(Debug, Clone, PartialEq)]
struct Element {
    joint: usize,
    law: Law,
    state: usize,
    column: usize,
}

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
        Ok(Some(self.add(tape, joint, law)))
    }

    /// ln(1 + t/T), t being the time since the series began.
    pub fn warmth(&mut self, tape: &mut Tape, joint: usize, warming_time: f64) -> Vec<Value> {
        self.add(tape, joint, Law::Warmth { warming_time })
    }

    fn add(&mut self, tape: &mut Tape, joint: usize, law: Law) -> Vec<Value> {
        let (variables, columns) = law.sizes();
        let (state, column) = (self.variables, self.columns);
        self.elements.push(Element { joint, law, state, column });
        self.variables += variables;
        self.columns += columns;
        (column..self.columns).map(|k| tape.input(format!("h[{k}]"))).collect()
    }

    /// The functions and tables that the laws need, at file scope.
    pub fn definitions(&self, language: Language) -> String {
        let mut text = String::new();
        let mut written: Vec<&str> = Vec::new();
        for name in self.elements.iter().flat_map(|e| e.law.functions()) {
            if !written.contains(name) {
                text.push_str(code(language, name));
                written.push(name);
            }
        }
        for element in &self.elements {
            if let Law::MaxwellSlip { thresholds } | Law::Gms { thresholds, .. } = &element.law {
                text.push_str(&language.table_definition(&element.table(), thresholds));
            }
        }
        text
    }

    /// The statements that begin a series at its first sample.
    pub fn beginning(&self, language: Language) -> String {
        let mut text = String::new();
        for element in &self.elements {
            let member = |variable: usize| language.member(&format!("m[{}]", element.state + variable));
            for variable in element.law.positions() {
                let _ = writeln!(text, "        {} = q[{}];", member(variable), element.joint);
            }
            if let Some(variable) = element.law.time() {
                let _ = writeln!(text, "        {} = t;", member(variable));
            }
        }
        text
    }

    /// The statements that move the memory on to the present sample and give the columns `h`.
    pub fn calls(&self, language: Language) -> String {
        self.elements.iter().map(|element| format!("    {};\n", element.call(language))).collect()
    }

    /// Whether the time of a sample matters.
    pub fn needs_time(&self) -> bool {
        self.elements.iter().any(|element| element.law.time().is_some())
    }

    /// Number of columns.
    pub const fn columns_count(&self) -> usize {
        self.columns
    }
}

impl Element {
    fn table(&self) -> String {
        format!("thresholds_{}", self.column)
    }

    fn call(&self, language: Language) -> String {
        let Self { joint, law, state, column } = self;
        let (variables, columns) = law.sizes();
        let memory = language.changed(&language.member("m"), *state, variables);
        let results = language.changed("h", *column, columns);
        let sample = format!("t, q[{joint}], qd[{joint}]");
        match law {
            Law::Dahl { presliding } => {
                format!("h[{column}] = dahl({memory}, q[{joint}], {})", literal(*presliding))
            }
            Law::LuGre { presliding, curve } => {
                let shape = [&[*presliding], curve.as_slice()].concat();
                format!("h[{column}] = lugre({memory}, {sample}, {})", list(&shape))
            }
            Law::BoucWen { presliding, exponent, beta } => {
                let shape = list(&[*presliding, *exponent, *beta]);
                format!("h[{column}] = bouc_wen({memory}, q[{joint}], {shape})")
            }
            Law::MaxwellSlip { thresholds } => {
                let table = language.table(&self.table(), thresholds.len());
                format!("maxwell_slip({memory}, q[{joint}], {table}, {results})")
            }
            Law::Gms { thresholds, curve, attraction } => {
                let table = language.table(&self.table(), thresholds.len());
                let shape = list(&[curve.as_slice(), &[*attraction]].concat());
                format!("gms({memory}, {sample}, {table}, {shape}, {results})")
            }
            Law::Warmth { warming_time } => {
                let began = language.member(&format!("m[{state}]"));
                format!("h[{column}] = warmth(t - {began}, {})", literal(*warming_time))
            }
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
            Self::Warmth { .. } => (1, 1),
        }
    }

    /// The variables that begin as the first position of a series; all others begin as zero.
    fn positions(&self) -> std::ops::Range<usize> {
        match self {
            Self::Dahl { .. } | Self::BoucWen { .. } | Self::Gms { .. } => 1..2,
            Self::LuGre { .. } => 2..3,
            Self::MaxwellSlip { thresholds } => 0..thresholds.len(),
            Self::Warmth { .. } => 0..0,
        }
    }

    /// The variable that holds the time of the previous sample, or of the first one.
    const fn time(&self) -> Option<usize> {
        match self {
            Self::LuGre { .. } => Some(1),
            Self::Gms { .. } | Self::Warmth { .. } => Some(0),
            _ => None,
        }
    }

    /// The functions that the law needs, in order; `within_one` is one of Rust alone.
    const fn functions(&self) -> &'static [&'static str] {
        match self {
            Self::Dahl { .. } => &["within_one", "relax", "dahl"],
            Self::LuGre { .. } => &["within_one", "relax", "level", "mean_velocity", "lugre"],
            Self::BoucWen { .. } => &["bouc_wen"],
            Self::MaxwellSlip { .. } => &["within_one", "maxwell_slip"],
            Self::Warmth { .. } => &["warmth"],
            Self::Gms { .. } => &["within_one", "level", "mean_velocity", "gms"],
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

/// The text of a function of [`Law::functions`].
fn code(language: Language, name: &str) -> &'static str {
    macro_rules! laws {
        ($($name:literal),*) => {
            match (language, name) {
                $(
                    (Language::C, $name) => include_str!(concat!("../c/laws/", $name, ".c")),
                    (Language::Rust, $name) => include_str!(concat!("../rust/laws/", $name, ".rs")),
                )*
                (Language::Rust, "within_one") => include_str!("../rust/laws/within_one.rs"),
                _ => "",
            }
        };
    }
    laws!("bouc_wen", "dahl", "gms", "level", "lugre", "maxwell_slip", "mean_velocity", "relax", "warmth")
}
