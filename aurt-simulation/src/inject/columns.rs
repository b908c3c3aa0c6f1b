use std::sync::Arc;

use aurt_rbd::base_parameters;
use aurt_traits::{BaseParameters, MotionView, RegressorTile, RigidBodyRegressor};

use super::real::Structure;
use crate::error::SimulationError;
use crate::robots::Robot;

/// The columns of a structure along motions: base inertial parameters, then the joints' terms.
#[derive(Debug, Clone)]
pub struct StructureColumns {
    pub(super) bodies: Arc<dyn RigidBodyRegressor>,
    base: BaseParameters,
    structure: Structure,
    /// Standard inertial parameters that give the load of load-dependent friction.
    pub(super) standard: Vec<f64>,
    /// For each joint, the coefficients of its row, ascending: base parameters, then Coulomb, viscous, rotor, load.
    rows: Vec<Vec<usize>>,
    coefficients: usize,
}

impl StructureColumns {
    /// The columns for rigid bodies under gravity, without a load.
    pub(super) fn new(
        bodies: Arc<dyn RigidBodyRegressor>,
        structure: Structure,
    ) -> Result<Self, SimulationError> {
        let base = base_parameters(&*bodies, 1)?;
        let mut rows: Vec<Vec<usize>> = (0..bodies.joints())
            .map(|j| (0..base.len()).filter(|k| bodies.loads(base.columns[*k], j)).collect())
            .collect();
        let mut coefficients = base.len();
        for (row, terms) in rows.iter_mut().zip(&structure.joints) {
            let own = [terms.coulomb, terms.viscous, terms.rotor, terms.load];
            let count = own.into_iter().filter(|there| *there).count();
            row.extend(coefficients..coefficients + count);
            coefficients += count;
        }
        let standard = vec![0.0; bodies.standard_parameters().len()];
        Ok(Self { bodies, base, structure, standard, rows, coefficients })
    }

    /// The columns for a simulated robot's geometry, gravity and bodies.
    pub fn of_robot(robot: &Robot, structure: &Structure) -> Result<Self, SimulationError> {
        let columns = Self::new(Arc::new(robot.chain()?), structure.clone())?;
        Ok(Self { standard: robot.standard_parameters(), ..columns })
    }

    pub fn joints(&self) -> usize {
        self.rows.len()
    }

    pub const fn coefficients(&self) -> usize {
        self.coefficients
    }

    pub fn row(&self, joint: usize) -> &[usize] {
        &self.rows[joint]
    }

    /// Sets the standard inertial parameters from coefficients: base parameters in the places of the standard ones that they are named after,
    /// nothing elsewhere.
    pub(super) fn set_load(&mut self, coefficients: &[f64]) {
        self.standard.fill(0.0);
        for (column, value) in self.base.columns.iter().zip(coefficients) {
            self.standard[*column] = *value;
        }
    }

    /// Coulomb and viscous coefficient of a joint; 0 where the structure has none, or where it is negative.
    pub(super) fn friction(&self, joint: usize, coefficients: &[f64]) -> [f64; 2] {
        let terms = self.structure.joints[joint];
        let mut own = self.rows[joint].iter().filter(|k| **k >= self.base.len());
        [terms.coulomb, terms.viscous].map(|there| {
            let coefficient = if there { own.next() } else { None };
            coefficient.map_or(0.0, |k| coefficients[*k]).max(0.0)
        })
    }

    /// The entries of each joint's row: `[joint][entry][sample]`.
    pub fn evaluate(&self, motion: MotionView<'_>) -> Vec<Vec<Vec<f64>>> {
        let (joints, samples) = (self.rows.len(), motion.samples());
        let parameters = self.standard.len();
        let mut destination = vec![RegressorTile::UNWANTED; joints * parameters];
        let mut columns = 0;
        for (j, row) in self.rows.iter().enumerate() {
            for k in row.iter().take_while(|k| **k < self.base.len()) {
                destination[j * parameters + self.base.columns[*k]] = columns;
                columns += 1;
            }
        }
        let mut data = vec![0.0; columns as usize * samples];
        self.bodies
            .evaluate(motion, &mut RegressorTile::new(&destination, parameters, samples, samples, &mut data));
        let mut load = vec![0.0; joints * samples];
        if self.structure.joints.iter().any(|t| t.load) {
            self.bodies.torque(motion, &self.standard, &mut load, samples);
        }
        let mut rigid = data.chunks_exact(samples.max(1));
        (0..joints)
            .map(|j| {
                let count = self.rows[j].iter().take_while(|k| **k < self.base.len()).count();
                let mut row: Vec<Vec<f64>> = rigid.by_ref().take(count).map(<[f64]>::to_vec).collect();
                let terms = self.structure.joints[j];
                let velocity = motion.velocity_rad_s(j);
                let sign = |v: &f64| if *v == 0.0 { 0.0 } else { v.signum() };
                if terms.coulomb {
                    row.push(velocity.iter().map(sign).collect());
                }
                if terms.viscous {
                    row.push(velocity.to_vec());
                }
                if terms.rotor {
                    row.push(motion.acceleration_rad_s2(j).to_vec());
                }
                if terms.load {
                    let load = &load[j * samples..(j + 1) * samples];
                    row.push(load.iter().zip(velocity).map(|(l, v)| l.abs() * sign(v)).collect());
                }
                row
            })
            .collect()
    }

    /// Residual of a joint's measurement; `entries` are those of the joint's row.
    pub fn left_over(
        &self,
        joint: usize,
        entries: &[Vec<f64>],
        measured: &[f64],
        coefficients: &[f64],
    ) -> Vec<f64> {
        let mut left = measured.to_vec();
        for (k, column) in self.rows[joint].iter().zip(entries) {
            for (l, y) in left.iter_mut().zip(column) {
                *l -= coefficients[*k] * y;
            }
        }
        left
    }
}
