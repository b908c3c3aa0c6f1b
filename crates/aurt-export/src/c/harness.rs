//! The program that compares the C functions with what the model itself predicts.

use std::fmt::Write;

use aurt_rbd::{ChainDynamics, SerialChain};

use super::{tape::literal, text::comment};
use crate::{ExportError, Source};

/// A sample of a motion and what the model predicts there.
#[derive(Debug, Clone, PartialEq)]
pub struct Check {
    /// Time, s.
    pub time_s: f64,
    /// Joint positions, rad.
    pub q_rad: Vec<f64>,
    /// Joint velocities, rad/s.
    pub qd_rad_s: Vec<f64>,
    /// Joint accelerations, rad/s².
    pub qdd_rad_s2: Vec<f64>,
    /// The model's prediction, Nm.
    pub torque_nm: Vec<f64>,
}

/// The largest difference that passes, relative to the largest stored value of its column.
const TOLERANCE: f64 = 1e-12;

/// Writes the program. Stored torques are those of the checks; gravity and mass matrix are those of
/// [`ChainDynamics`], whose code the export does not share.
pub(super) fn program(
    source: &Source<'_>,
    chain: &SerialChain,
    checks: &[Check],
    memoryless: bool,
) -> Result<String, ExportError> {
    let joints = chain.joints().len();
    let mut bodies = ChainDynamics::new(chain.clone(), &source.bodies(|k| source.coefficients[k])?)?
        .with_rotor_inertia(&source.rotor_inertia_kg_m2())?;
    let rest = vec![0.0; joints];
    let mut tables: [(&str, usize, Vec<Vec<f64>>); 8] = [
        ("t", 1, Vec::new()),
        ("q", joints, Vec::new()),
        ("qd", joints, Vec::new()),
        ("qdd", joints, Vec::new()),
        ("torque", joints, Vec::new()),
        ("rigid", joints, Vec::new()),
        ("gravity", joints, Vec::new()),
        ("mass", joints * joints, Vec::new()),
    ];
    for check in checks {
        let (mut rigid, mut gravity, mut mass) = (rest.clone(), rest.clone(), vec![0.0; joints * joints]);
        for values in [&check.q_rad, &check.qd_rad_s, &check.qdd_rad_s2, &check.torque_nm] {
            if values.len() != joints {
                let found = values.len();
                return Err(ExportError::Count { what: "values of a check", expected: joints, found });
            }
        }
        bodies.inverse_dynamics(&check.q_rad, &check.qd_rad_s, &check.qdd_rad_s2, &mut rigid);
        bodies.bias_torque(&check.q_rad, &rest, &mut gravity);
        bodies.mass_matrix(&check.q_rad, &mut mass);
        let rows = [
            vec![check.time_s],
            check.q_rad.clone(),
            check.qd_rad_s.clone(),
            check.qdd_rad_s2.clone(),
            check.torque_nm.clone(),
            rigid,
            gravity,
            mass,
        ];
        for ((_, _, table), row) in tables.iter_mut().zip(rows) {
            table.push(row);
        }
    }
    let mut lines = vec![
        format!("Compares {}.c with values that the model itself predicts.", source.name),
        format!(
            "cc -std=c99 -O2 {}.c main.c -lm -o check, then ./check: exit status 0 if all agree.",
            source.name
        ),
    ];
    lines.extend(source.provenance.lines());
    let mut text = comment(&lines);
    let _ = write!(
        text,
        "#include \"{}.h\"\n\n#include <math.h>\n#include <stdio.h>\n#include <string.h>\n\n",
        source.name
    );
    let _ = write!(text, "#define JOINTS {joints}\n#define STATES {}\n\n", checks.len());
    for (name, width, rows) in &tables {
        let _ = writeln!(text, "static const double {name}[STATES][{width}] = {{");
        for row in rows {
            let numbers: Vec<String> = row.iter().map(|v| literal(*v)).collect();
            let _ = writeln!(text, "    {{{}}},", numbers.join(", "));
        }
        text.push_str("};\n\n");
    }
    let memoryless = u8::from(memoryless).to_string();
    let main = [("@NAME@", source.name), ("@TOLERANCE@", &literal(TOLERANCE)), ("@MEMORYLESS@", &memoryless)];
    text.push_str(&main.iter().fold(MAIN.to_owned(), |text, (mark, word)| text.replace(mark, word)));
    Ok(text)
}

const MAIN: &str = include_str!("harness_main.c");
