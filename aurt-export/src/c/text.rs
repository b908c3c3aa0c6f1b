//! The header and the source as text.

use std::fmt::Write;

use aurt_rbd::{JointKind, SerialChain};
use aurt_traits::MeasurementUnit;

use crate::Source;
use crate::naming::{c_string, for_comment};
use crate::program::{Body, Function, Language, Program, Tunable};

pub(super) fn comment(lines: &[String]) -> String {
    let mut text = String::from("/*\n");
    for line in lines {
        let _ = writeln!(text, " * {}", for_comment(line));
    }
    text.push_str(" */\n");
    text
}

fn prototype(name: &str, joints: usize, function: &Function) -> String {
    let mut arguments = Vec::new();
    if function.steps {
        arguments.push(format!("{name}_state *state"));
    }
    arguments.extend(function.parameters.map(|count| format!("const double p[{count}]")));
    if function.steps {
        arguments.push("double t".into());
    }
    arguments.extend(function.arguments.iter().map(|a| format!("const double {a}[{joints}]")));
    let (result, length) = function.result;
    arguments.push(format!("double {result}[{length}]"));
    format!("void {name}_{}({})", function.name, arguments.join(", "))
}

/// Units, frames and gravity.
pub(crate) fn facts(source: &Source<'_>, chain: &SerialChain) -> Vec<String> {
    let prismatic: Vec<String> = (chain.joints().iter().enumerate())
        .filter(|(_, j)| j.kind == JointKind::Prismatic)
        .map(|(k, _)| k.to_string())
        .collect();
    let torque = if source.unit == MeasurementUnit::Ampere { "A" } else { "N m" };
    let mut lines =
        vec![format!("Units: q in rad, qd in rad/s, qdd in rad/s^2, tau in {torque}; joints count from 0.")];
    if !prismatic.is_empty() {
        lines.push(format!(
            "Prismatic joints ({}): q in m, qd in m/s, qdd in m/s^2, tau in N.",
            prismatic.join(", ")
        ));
    }
    let [x, y, z] = chain.gravity_m_s2();
    lines.push(format!("Gravity in the base frame: {x} {y} {z} m/s^2."));
    lines
}

/// The header; with the parameters that can be chosen, if any can.
pub(crate) fn header(
    source: &Source<'_>,
    chain: &SerialChain,
    program: &Program,
    tunable: Option<&Tunable>,
) -> String {
    let name = source.name;
    let joints = chain.joints().len();
    let guard = format!("{}_H", name.to_uppercase());
    let target = if tunable.is_some() { "fmu" } else { "c" };
    let mut lines = vec![format!("Dynamics of {name}, written by `aurt export {target}`."), String::new()];
    lines.extend(source.provenance.lines());
    lines.push(String::new());
    lines.extend(facts(source, chain));
    lines.push(
        "Arguments and results must not overlap. Nothing is allocated, nothing is remembered but in the state.".into(),
    );
    let mut text = comment(&lines);
    let _ =
        write!(text, "#ifndef {guard}\n#define {guard}\n\n#define {}_JOINTS {joints}\n", name.to_uppercase());
    if let Some(tunable) = tunable {
        let _ = write!(text, "#define {}_PARAMETERS {}\n\n", name.to_uppercase(), tunable.parameters().len());
        let lines = tunable.parameters().iter().enumerate();
        let mut lines: Vec<String> =
            lines.map(|(k, p)| format!("p[{k}] = {}: {}, {}", p.start, p.name, p.description)).collect();
        lines.insert(0, "The parameters of a step and their values in the calibration:".into());
        text.push_str(&comment(&lines));
    }
    text.push_str("\n#ifdef __cplusplus\nextern \"C\" {\n#endif\n\n");
    if !chain.joint_names().is_empty() {
        let upper = name.to_uppercase();
        let _ = write!(
            text,
            "/* Names of the joints, base first. */\nextern const char *const {name}_joint_names[{upper}_JOINTS];\n\n"
        );
    }
    let variables = program.memory.variables();
    let memory = if variables > 0 { format!("    double m[{variables}];\n") } else { String::new() };
    let _ = write!(
        text,
        "/* What friction remembers from sample to sample. */\ntypedef struct {{\n    int started;\n{memory}}} \
         {name}_state;\n\n/* Begins a series: friction starts relaxed at the first sample that follows. */\n\
         void {name}_reset({name}_state *state);\n"
    );
    for function in &program.functions {
        let cost = format!("{} of functions.", function.operations);
        let _ = write!(
            text,
            "\n{}{};\n",
            comment(&[function.summary.to_owned(), cost]),
            prototype(name, joints, function)
        );
    }
    text.push_str("\n#ifdef __cplusplus\n}\n#endif\n\n#endif\n");
    text
}

pub(crate) fn implementation(source: &Source<'_>, program: &Program) -> String {
    let (name, joints, functions) = (source.name, source.model.joints(), &program.functions);
    let mut lines = vec![format!("Dynamics of {name}; see {name}.h.")];
    lines.extend(source.provenance.lines());
    let mut text = comment(&lines);
    let _ = write!(text, "#include \"{name}.h\"\n\n#include <math.h>\n");
    let names: Vec<String> = source.model.rigid_body().joint_names().iter().map(|n| c_string(n)).collect();
    if !names.is_empty() {
        let _ = write!(
            text,
            "\nconst char *const {name}_joint_names[{joints}] = {{\n    {}\n}};\n",
            names.join(",\n    ")
        );
    }
    let bodies: Vec<String> = functions.iter().map(|f| body(name, f, program)).collect();
    if bodies.iter().any(|b| b.contains("sign_beyond(")) {
        text.push_str(
            "\n/* The sign of v where |v| exceeds rest, else 0. */\n\
             static double sign_beyond(double v, double rest)\n{\n    \
             double sign = 0.0;\n    if (v > rest) {\n        sign = 1.0;\n    } else if (v < -rest) {\n        \
             sign = -1.0;\n    } else {\n        sign = 0.0;\n    }\n    return sign;\n}\n",
        );
    }
    text.push_str(&program.memory.definitions(Language::C));
    let _ = write!(text, "\nvoid {name}_reset({name}_state *state)\n{{\n    state->started = 0;\n");
    if program.memory.variables() > 0 {
        let _ = write!(
            text,
            "    int k;\n    for (k = 0; k < {}; ++k) {{\n        state->m[k] = 0.0;\n    }}\n",
            program.memory.variables()
        );
    }
    text.push_str("}\n");
    for (function, body) in functions.iter().zip(&bodies) {
        let _ = write!(text, "\n{}\n{{\n", prototype(name, joints, function));
        for argument in function.arguments.iter().filter(|a| !uses(body, a)) {
            let _ = writeln!(text, "    (void){argument};");
        }
        text.push_str(body);
        text.push_str("}\n");
    }
    text
}

fn body(name: &str, function: &Function, program: &Program) -> String {
    let memory = &program.memory;
    let mut text = String::new();
    if function.steps && memory.is_empty() {
        text.push_str("    (void)t;\n    state->started = 1;\n");
    } else if function.steps {
        let _ = writeln!(text, "    double h[{}];", memory.columns_count());
        text.push_str("    if (state->started == 0) {\n");
        text.push_str(&memory.beginning(Language::C));
        text.push_str("        state->started = 1;\n    }\n");
        text.push_str(&memory.calls(Language::C));
        if !memory.needs_time() {
            text.push_str("    (void)t;\n");
        }
    }
    match function.body {
        Body::Line(..) => text.push_str(&function.statements(Language::C)),
        Body::Torque => {
            let _ = writeln!(text, "    {name}_torque(q, qd, qdd, tau);");
        }
    }
    text
}

fn uses(body: &str, argument: &str) -> bool {
    [format!(" {argument}["), format!("({argument}["), format!("({argument},"), format!(" {argument},")]
        .iter()
        .any(|use_of| body.contains(use_of))
}
