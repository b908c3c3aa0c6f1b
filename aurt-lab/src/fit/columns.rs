use aurt_rbd::{SerialChain, base_parameters};
use aurt_simulation::{SimulationError, inject::Structure, robots::Robot};
use aurt_traits::{BaseParameters, MotionView, RegressorTile, RigidBodyRegressor};

/// The columns of a structure along motions: base inertial parameters, then the joints' terms.
#[derive(Debug)]
pub(crate) struct Columns {
    chain: SerialChain,
    base: BaseParameters,
    standard: Vec<f64>,
    structure: Structure,
    /// For each joint, the coefficients of its row, ascending.
    rows: Vec<Vec<usize>>,
    coefficients: usize,
}

impl Columns {
    /// The columns for a robot's geometry and gravity; its bodies give the load of load-dependent friction.
    pub fn new(robot: &Robot, structure: &Structure) -> Result<Self, SimulationError> {
        let chain = robot.chain()?;
        let base = base_parameters(&chain, 1)?;
        let mut rows: Vec<Vec<usize>> = (0..robot.joints())
            .map(|j| (0..base.len()).filter(|k| chain.loads(base.columns[*k], j)).collect())
            .collect();
        let mut coefficients = base.len();
        for (row, terms) in rows.iter_mut().zip(&structure.joints) {
            let count =
                [terms.coulomb, terms.viscous, terms.rotor, terms.load].into_iter().filter(|t| *t).count();
            row.extend(coefficients..coefficients + count);
            coefficients += count;
        }
        let standard = robot.standard_parameters();
        Ok(Self { chain, base, standard, structure: structure.clone(), rows, coefficients })
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

    /// The entries of each joint's row: `[joint][entry][sample]`.
    pub fn evaluate(&self, motion: MotionView<'_>) -> Vec<Vec<Vec<f64>>> {
        let (joints, samples) = (self.rows.len(), motion.samples());
        let parameters = joints * aurt_rbd::INERTIAL_PARAMETERS;
        let mut destination = vec![RegressorTile::UNWANTED; joints * parameters];
        let mut columns = 0;
        for j in 0..joints {
            for p in (0..parameters).filter(|p| self.chain.loads(*p, j)) {
                destination[j * parameters + p] = columns;
                columns += 1;
            }
        }
        let mut data = vec![0.0; columns as usize * samples];
        let mut tile = RegressorTile::new(&destination, parameters, samples, samples, &mut data);
        self.chain.evaluate(motion, &mut tile);
        let column = |joint: usize, parameter: usize| {
            let d = destination[joint * parameters + parameter] as usize;
            &data[d * samples..(d + 1) * samples]
        };
        (0..joints)
            .map(|j| {
                let rigid = self.rows[j].iter().take_while(|k| **k < self.base.len());
                let mut row: Vec<Vec<f64>> =
                    rigid.map(|k| column(j, self.base.columns[*k]).to_vec()).collect();
                let terms = self.structure.joints[j];
                let velocity = motion.velocity_rad_s(j);
                let sign = |v: f64| if v == 0.0 { 0.0 } else { v.signum() };
                if terms.coulomb {
                    row.push(velocity.iter().map(|v| sign(*v)).collect());
                }
                if terms.viscous {
                    row.push(velocity.to_vec());
                }
                if terms.rotor {
                    row.push(motion.acceleration_rad_s2(j).to_vec());
                }
                if terms.load {
                    let mut load = vec![0.0; samples];
                    for p in (0..parameters).filter(|p| self.chain.loads(*p, j)) {
                        for (l, y) in load.iter_mut().zip(column(j, p)) {
                            *l += self.standard[p] * y;
                        }
                    }
                    row.push(load.iter().zip(velocity).map(|(l, v)| l.abs() * sign(*v)).collect());
                }
                row
            })
            .collect()
    }
}
