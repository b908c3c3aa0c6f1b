//! The rigid bodies with rotors that can change from call to call.

use aurt_rbd::ChainDynamics;

use crate::error::SimulationError;
use crate::robots::Robot;

/// Rotor inertia that holds a joint in its place, kg m²: the acceleration that any torque gives it is below
/// what rounding leaves.
pub(crate) const LOCKED_KG_M2: f64 = 1e12;

/// Forward dynamics of the links by the articulated-body algorithm.
#[derive(Debug)]
pub(crate) struct Arm {
    dynamics: Option<ChainDynamics>,
    weightless: Option<ChainDynamics>,
    rotors_kg_m2: Vec<f64>,
    weightless_rotors_kg_m2: Vec<f64>,
    rest: Vec<f64>,
}

impl Arm {
    pub fn new(robot: &Robot) -> Result<Self, SimulationError> {
        let chain = robot.chain()?;
        let standard = robot.standard_parameters();
        let joints = robot.joints();
        Ok(Self {
            weightless: Some(ChainDynamics::new(chain.under_gravity([0.0; 3]), &standard)?),
            dynamics: Some(ChainDynamics::new(chain, &standard)?),
            rotors_kg_m2: vec![0.0; joints],
            weightless_rotors_kg_m2: vec![0.0; joints],
            rest: vec![0.0; joints],
        })
    }

    /// q̈ under the torques, with the given rotor inertias on the joints.
    pub fn accelerations(
        &mut self,
        q_rad: &[f64],
        qd_rad_s: &[f64],
        torque_nm: &[f64],
        rotors_kg_m2: &[f64],
        qdd_rad_s2: &mut [f64],
    ) -> Result<(), SimulationError> {
        set_rotors(&mut self.dynamics, &mut self.rotors_kg_m2, rotors_kg_m2)?;
        if let Some(dynamics) = &mut self.dynamics {
            dynamics.forward_dynamics(q_rad, qd_rad_s, torque_nm, qdd_rad_s2);
        }
        Ok(())
    }

    /// M⁻¹ τ at rest and without gravity: what a torque alone does to the accelerations.
    pub fn response(
        &mut self,
        q_rad: &[f64],
        torque_nm: &[f64],
        rotors_kg_m2: &[f64],
        qdd_rad_s2: &mut [f64],
    ) -> Result<(), SimulationError> {
        set_rotors(&mut self.weightless, &mut self.weightless_rotors_kg_m2, rotors_kg_m2)?;
        if let Some(dynamics) = &mut self.weightless {
            dynamics.forward_dynamics(q_rad, &self.rest, torque_nm, qdd_rad_s2);
        }
        Ok(())
    }
}

/// Gives the dynamics other rotors, if they are others.
fn set_rotors(
    dynamics: &mut Option<ChainDynamics>,
    present: &mut [f64],
    wanted: &[f64],
) -> Result<(), SimulationError> {
    if present != wanted
        && let Some(taken) = dynamics.take()
    {
        *dynamics = Some(taken.with_rotor_inertia(wanted)?);
        present.copy_from_slice(wanted);
    }
    Ok(())
}
