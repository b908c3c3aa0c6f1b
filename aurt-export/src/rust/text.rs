//! The manifest and the source as text.

use std::fmt::Write;

use aurt_rbd::SerialChain;

use crate::Source;
use crate::c::text::facts;
use crate::naming::for_comment;
use crate::program::{Body, Function, Language, Program};

pub(super) fn comment(mark: &str, lines: &[String]) -> String {
    lines.iter().map(|line| format!("{mark} {}", for_comment(line)).trim_end().to_owned() + "\n").collect()
}

pub(super) fn manifest(source: &Source<'_>) -> String {
    let provenance = comment("#", &source.provenance.lines());
    MANIFEST.replace("@NAME@", source.name).replace("@PROVENANCE@\n", &provenance)
}

/// `src/lib.rs`.
pub(super) fn library(source: &Source<'_>, chain: &SerialChain, program: &Program) -> String {
    let joints = chain.joints().len();
    let mut lines =
        vec![format!("Dynamics of {}, written by `aurt export rust`.", source.name), String::new()];
    lines.extend(source.provenance.lines());
    lines.push(String::new());
    lines.extend(facts(source, chain));
    let mut text = comment("//!", &lines);
    let variables = program.memory.variables();
    text.push_str(
        &LIBRARY.replace("@JOINTS@", &joints.to_string()).replace("@MEMORY@", &variables.to_string()),
    );
    if !chain.joint_names().is_empty() {
        // What `Debug` writes of a text is a literal of Rust.
        let names = chain.joint_names().iter().map(|name| format!("    {name:?},\n")).collect::<String>();
        let _ = write!(
            text,
            "\n/// Names of the joints, base first.\npub const JOINT_NAMES: [&str; JOINTS] = [\n{names}];\n"
        );
    }
    let bodies: Vec<String> = program.functions.iter().map(|f| body(f, program)).collect();
    if bodies.iter().any(|b| b.contains("sign_beyond(")) {
        text.push_str(SIGN_BEYOND);
    }
    text.push_str(&program.memory.definitions(Language::Rust));
    for (function, body) in program.functions.iter().zip(&bodies) {
        let cost = format!("{} of functions.", function.operations);
        let documentation = comment("///", &[function.summary.to_owned(), String::new(), cost]);
        let _ = write!(text, "\n{documentation}{} {{\n{body}}}\n", signature(joints, function));
    }
    text
}

fn signature(joints: usize, function: &Function) -> String {
    let mut arguments = Vec::new();
    if function.steps {
        arguments.extend(["state: &mut State".to_owned(), "t: f64".to_owned()]);
    }
    arguments.extend(function.arguments.iter().map(|a| format!("{a}: &[f64; {joints}]")));
    format!("pub fn {}({}) -> [f64; {}]", function.name, arguments.join(", "), function.result.1)
}

fn body(function: &Function, program: &Program) -> String {
    let memory = &program.memory;
    let mut text = String::new();
    if function.steps && memory.is_empty() {
        text.push_str("    state.started = true;\n");
    } else if function.steps {
        let _ = writeln!(text, "    let mut h = [0.0; {}];", memory.columns_count());
        text.push_str("    if !state.started {\n");
        text.push_str(&memory.beginning(Language::Rust));
        text.push_str("        state.started = true;\n    }\n");
        text.push_str(&memory.calls(Language::Rust));
    }
    match function.body {
        Body::Line(..) => {
            let (result, length) = function.result;
            let statements = function.statements(Language::Rust);
            let _ = write!(text, "    let mut {result} = [0.0; {length}];\n{statements}    {result}\n");
        }
        Body::Torque => text.push_str("    torque(q, qd, qdd)\n"),
    }
    text
}

const MANIFEST: &str = include_str!("manifest.toml");
const LIBRARY: &str = include_str!("library.rs");

const SIGN_BEYOND: &str = "
/// The sign of v where |v| exceeds rest, else 0.
fn sign_beyond(v: f64, rest: f64) -> f64 {
    if v > rest {
        1.0
    } else if v < -rest {
        -1.0
    } else {
        0.0
    }
}
";
