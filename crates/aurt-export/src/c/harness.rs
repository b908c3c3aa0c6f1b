//! The program that compares the C functions with what the model itself predicts.

use std::fmt::Write;

use aurt_rbd::{ChainDynamics, SerialChain};

use super::{tape::literal, text::comment};
use crate::{ExportError, Source};

/// A state and what the model predicts there.
#[derive(Debug, Clone, PartialEq)]
pub struct Check {
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
) -> Result<String, ExportError> {
    let joints = chain.joints().len();
    let mut bodies = ChainDynamics::new(chain.clone(), &source.bodies(|k| source.coefficients[k]))?
        .with_rotor_inertia(&source.rotor_inertia_kg_m2())?;
    let rest = vec![0.0; joints];
    let mut tables: [(&str, usize, Vec<Vec<f64>>); 7] = [
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
    let _ = write!(text, "#include \"{}.h\"\n\n#include <math.h>\n#include <stdio.h>\n\n", source.name);
    let _ = write!(text, "#define JOINTS {joints}\n#define STATES {}\n\n", checks.len());
    for (name, width, rows) in &tables {
        let _ = writeln!(text, "static const double {name}[STATES][{width}] = {{");
        for row in rows {
            let numbers: Vec<String> = row.iter().map(|v| literal(*v)).collect();
            let _ = writeln!(text, "    {{{}}},", numbers.join(", "));
        }
        text.push_str("};\n\n");
    }
    text.push_str(&MAIN.replace("@NAME@", source.name).replace("@TOLERANCE@", &literal(TOLERANCE)));
    Ok(text)
}

const MAIN: &str = r#"/* The largest size in a table. */
static double largest_of(const double *stored, int length)
{
    double size = 0.0;
    int k;
    for (k = 0; k < length; ++k) {
        size = fabs(stored[k]) > size ? fabs(stored[k]) : size;
    }
    return size;
}

/* The largest difference of a column, relative to its largest stored value or a thousandth of the table's, in which columns
   that are zero but for rounding count; -1 if a value is not a number. */
static double worst(const double *stored, const double *found, int width, int column)
{
    double size = 1e-3 * largest_of(stored, STATES * width);
    double difference = 0.0;
    int state;
    for (state = 0; state < STATES; ++state) {
        const double s = stored[state * width + column];
        const double d = fabs(found[state * width + column] - s);
        if (d != d) {
            return -1.0;
        }
        size = fabs(s) > size ? fabs(s) : size;
        difference = d > difference ? d : difference;
    }
    return difference > 0.0 ? difference / size : 0.0;
}

static int compare(const char *what, const double *stored, const double *found, int width)
{
    double largest = 0.0;
    int passed = 1;
    int column;
    for (column = 0; column < width; ++column) {
        const double w = worst(stored, found, width, column);
        if (!(w >= 0.0 && w <= @TOLERANCE@)) {
            passed = 0;
            printf("%s[%d]: differs by %.3g of the largest value\n", what, column, w);
        }
        largest = w > largest ? w : largest;
    }
    printf("%-18s %s, largest relative difference %.3g\n", what, passed ? "passed" : "FAILED", largest);
    return passed;
}

int main(void)
{
    static double full[STATES][JOINTS];
    static double parts[STATES][JOINTS];
    static double bodies[STATES][JOINTS];
    static double weight[STATES][JOINTS];
    static double matrix[STATES][JOINTS * JOINTS];
    int passed = 1;
    int state;
    int joint;
    for (state = 0; state < STATES; ++state) {
        @NAME@_torque(q[state], qd[state], qdd[state], full[state]);
        @NAME@_rigid_body_torque(q[state], qd[state], qdd[state], bodies[state]);
        @NAME@_friction_torque(q[state], qd[state], qdd[state], parts[state]);
        @NAME@_gravity(q[state], weight[state]);
        @NAME@_mass_matrix(q[state], matrix[state]);
        for (joint = 0; joint < JOINTS; ++joint) {
            parts[state][joint] += bodies[state][joint];
        }
    }
    passed &= compare("torque", &torque[0][0], &full[0][0], JOINTS);
    passed &= compare("torque by parts", &torque[0][0], &parts[0][0], JOINTS);
    passed &= compare("rigid_body_torque", &rigid[0][0], &bodies[0][0], JOINTS);
    passed &= compare("gravity", &gravity[0][0], &weight[0][0], JOINTS);
    passed &= compare("mass_matrix", &mass[0][0], &matrix[0][0], JOINTS * JOINTS);
    return passed ? 0 : 1;
}
"#;
