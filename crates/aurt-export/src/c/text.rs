//! The header and the source as text.

use std::fmt::Write;

use aurt_rbd::{JointKind, SerialChain};

use super::functions::Function;
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
    let mut arguments: Vec<String> =
        function.arguments.iter().map(|a| format!("const double {a}[{joints}]")).collect();
    let (result, length) = function.result;
    arguments.push(format!("double {result}[{length}]"));
    format!("void {name}_{}({})", function.name, arguments.join(", "))
}

pub(super) fn header(source: &Source<'_>, chain: &SerialChain, functions: &[Function]) -> String {
    let name = source.name;
    let joints = chain.joints().len();
    let guard = format!("{}_H", name.to_uppercase());
    let mut lines = vec![format!("Dynamics of {name}, written by `aurt export c`."), String::new()];
    lines.extend(source.provenance.lines());
    lines.push(String::new());
    let prismatic: Vec<String> = (chain.joints().iter().enumerate())
        .filter(|(_, j)| j.kind == JointKind::Prismatic)
        .map(|(k, _)| k.to_string())
        .collect();
    lines.push("Units: q in rad, qd in rad/s, qdd in rad/s^2, tau in N m; joints count from 0.".into());
    if !prismatic.is_empty() {
        lines.push(format!(
            "Prismatic joints ({}): q in m, qd in m/s, qdd in m/s^2, tau in N.",
            prismatic.join(", ")
        ));
    }
    let [x, y, z] = chain.gravity_m_s2();
    lines.push(format!("Gravity in the base frame: {x} {y} {z} m/s^2."));
    lines.push("Arguments and results must not overlap. Nothing is allocated, nothing is remembered.".into());
    let mut text = comment(&lines);
    let _ =
        write!(text, "#ifndef {guard}\n#define {guard}\n\n#define {}_JOINTS {joints}\n", name.to_uppercase());
    text.push_str("\n#ifdef __cplusplus\nextern \"C\" {\n#endif\n");
    for function in functions {
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

pub(super) fn implementation(source: &Source<'_>, functions: &[Function]) -> String {
    let (name, joints) = (source.name, source.model.joints());
    let mut lines = vec![format!("Dynamics of {name}, written by `aurt export c`; see {name}.h.")];
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
    for function in functions {
        let _ = write!(text, "\n{}\n{{\n", prototype(name, joints, function));
        for argument in function.arguments.iter().filter(|a| !function.body.contains(&format!("{a}["))) {
            let _ = writeln!(text, "    (void){argument};");
        }
        text.push_str(&function.body);
        text.push_str("}\n");
    }
    text
}
