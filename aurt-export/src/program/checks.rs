//! Values with which the program beside a source compares it.

use aurt_rbd::{ChainDynamics, SerialChain};

use super::language::literal;
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

/// A program that compares, with the name of the model, the tolerance and the word for another mark.
pub(crate) fn filled(template: &str, source: &Source<'_>, (mark, word): (&str, &str)) -> String {
    let named = template.replace("@NAME@", source.name);
    named.replace("@TOLERANCE@", &literal(TOLERANCE)).replace(mark, word)
}

/// How many of the samples have a regressor, which is large.
const WITH_REGRESSOR: usize = 4;

/// Values of one kind, a row a sample.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Table {
    pub name: &'static str,
    pub width: usize,
    pub rows: Vec<Vec<f64>>,
}

/// The tables of some samples. Torques are those of the checks; those of the bodies, gravity, mass matrix and regressor are
/// those of [`ChainDynamics`], whose code the export does not share.
pub(crate) fn tables(
    source: &Source<'_>,
    chain: &SerialChain,
    checks: &[Check],
) -> Result<[Table; 9], ExportError> {
    let joints = chain.joints().len();
    let base = &source.model.base().columns;
    let mut bodies = ChainDynamics::new(chain.clone(), &source.bodies(|k| source.coefficients[k])?)?
        .with_rotor_inertia(&source.rotor_inertia_kg_m2())?;
    let mut of_columns = (base.iter())
        .map(|place| {
            let mut unit = vec![0.0; source.model.rigid_body().standard_parameters().len()];
            unit[*place] = 1.0;
            ChainDynamics::new(chain.clone(), &unit)
        })
        .collect::<Result<Vec<ChainDynamics>, _>>()?;
    let rest = vec![0.0; joints];
    let mut tables = [
        ("t", 1),
        ("q", joints),
        ("qd", joints),
        ("qdd", joints),
        ("torque", joints),
        ("rigid", joints),
        ("gravity", joints),
        ("mass", joints * joints),
        ("regressor", joints * base.len()),
    ]
    .map(|(name, width)| Table { name, width, rows: Vec::new() });
    for (n, check) in checks.iter().enumerate() {
        let Check { time_s, q_rad, qd_rad_s, qdd_rad_s2, torque_nm } = check;
        let (mut rigid, mut gravity, mut mass) = (rest.clone(), rest.clone(), vec![0.0; joints * joints]);
        for values in [q_rad, qd_rad_s, qdd_rad_s2, torque_nm] {
            if values.len() != joints {
                let found = values.len();
                return Err(ExportError::Count { what: "values of a check", expected: joints, found });
            }
        }
        bodies.inverse_dynamics(q_rad, qd_rad_s, qdd_rad_s2, &mut rigid);
        bodies.bias_torque(q_rad, &rest, &mut gravity);
        bodies.mass_matrix(q_rad, &mut mass);
        let [q, qd, qdd, torque] = [q_rad, qd_rad_s, qdd_rad_s2, torque_nm].map(Clone::clone);
        let rows = [vec![*time_s], q, qd, qdd, torque, rigid, gravity, mass];
        for (table, row) in tables.iter_mut().zip(rows) {
            table.rows.push(row);
        }
        if n < WITH_REGRESSOR {
            let mut row = vec![0.0; joints * base.len()];
            let mut column = rest.clone();
            for (k, body) in of_columns.iter_mut().enumerate() {
                body.inverse_dynamics(q_rad, qd_rad_s, qdd_rad_s2, &mut column);
                column.iter().enumerate().for_each(|(joint, value)| row[joint * base.len() + k] = *value);
            }
            tables[8].rows.push(row);
        }
    }
    Ok(tables)
}
