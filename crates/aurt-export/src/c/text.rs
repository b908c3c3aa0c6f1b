//! The header and the source as text.

use std::fmt::Write;

use aurt_rbd::{JointKind, SerialChain};
use aurt_traits::MeasurementUnit;

use super::{
    functions::{Function, Program},
    tunable::Tunable,
};
use crate::{Source, naming::for_comment};

/// A comment block.
pub(super) fn comment(lines: &[String]) -> String {
    let mut text = String::from("/*\n");
    for line in lines {
        let _ = writeln!(text, " * {}", for_comment(line));
    }
    text.push_str(" */\n");
    text
}

fn prototype(name: &str, joints: usize, function: &Function) -> String {
    let mut arguments = function.leading.clone();
    arguments.extend(function.arguments.iter().map(|a| format!("const double {a}[{joints}]")));
    let (result, length) = function.result;
    arguments.push(format!("double {result}[{length}]"));
    format!("void {name}_{}({})", function.name, arguments.join(", "))
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
    let prismatic: Vec<String> = (chain.joints().iter().enumerate())
        .filter(|(_, j)| j.kind == JointKind::Prismatic)
        .map(|(k, _)| k.to_string())
        .collect();
    let torque = if source.unit == MeasurementUnit::Ampere { "A" } else { "N m" };
    lines
        .push(format!("Units: q in rad, qd in rad/s, qdd in rad/s^2, tau in {torque}; joints count from 0."));
    if !prismatic.is_empty() {
        lines.push(format!(
            "Prismatic joints ({}): q in m, qd in m/s, qdd in m/s^2, tau in N.",
            prismatic.join(", ")
        ));
    }
    let [x, y, z] = chain.gravity_m_s2();
    lines.push(format!("Gravity in the base frame: {x} {y} {z} m/s^2."));
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
    let variables = program.memory.variables();
    let memory = if variables > 0 { format!("    double m[{variables}];\n") } else { String::new() };
    let _ = write!(
        text,
        "/* What friction remembers from sample to sample. */\ntypedef struct {{\n    int started;\n{memory}}} \
         {name}_state;\n\n/* Begins a series: friction starts relaxed at the first sample that follows. */\n\
         void {name}_reset({name}_state *state);\n"
    );
    for function in &program.functions {
        let o = &function.operations;
        let cost = format!(
            "{} multiplications, {} additions, {} calls of functions.",
            o.multiplications, o.additions, o.calls
        );
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

/// The source.
pub(crate) fn implementation(source: &Source<'_>, program: &Program) -> String {
    let (name, joints, functions) = (source.name, source.model.joints(), &program.functions);
    let mut lines = vec![format!("Dynamics of {name}; see {name}.h.")];
    lines.extend(source.provenance.lines());
    let mut text = comment(&lines);
    let _ = write!(text, "#include \"{name}.h\"\n\n#include <math.h>\n");
    if functions.iter().any(|f| f.body.contains("sign_beyond(")) {
        text.push_str(
            "\n/* The sign of v where |v| exceeds rest, else 0. */\n\
             static double sign_beyond(double v, double rest)\n{\n    \
             double sign = 0.0;\n    if (v > rest) {\n        sign = 1.0;\n    } else if (v < -rest) {\n        \
             sign = -1.0;\n    } else {\n        sign = 0.0;\n    }\n    return sign;\n}\n",
        );
    }
    text.push_str(&program.memory.definitions());
    let _ = write!(text, "\nvoid {name}_reset({name}_state *state)\n{{\n    state->started = 0;\n");
    if program.memory.variables() > 0 {
        let _ = write!(
            text,
            "    int k;\n    for (k = 0; k < {}; ++k) {{\n        state->m[k] = 0.0;\n    }}\n",
            program.memory.variables()
        );
    }
    text.push_str("}\n");
    for function in functions {
        let _ = write!(text, "\n{}\n{{\n", prototype(name, joints, function));
        for argument in function.arguments.iter().filter(|a| !uses(&function.body, a)) {
            let _ = writeln!(text, "    (void){argument};");
        }
        text.push_str(&function.body);
        text.push_str("}\n");
    }
    text
}

/// Whether statements use an argument.
fn uses(body: &str, argument: &str) -> bool {
    [format!(" {argument}["), format!("({argument}["), format!("({argument},"), format!(" {argument},")]
        .iter()
        .any(|use_of| body.contains(use_of))
}
