//! `joint_compliance`: a joint that gives way under its load, in proportion to it.
//!
//! # Equation
//! The encoder of the motor shows q, the link stands at q + δ e_j with δ = −c τ_j(q + δ e_j), where τ is the torque of the rigid
//! bodies, τ_j the load of the joint, and c = 1/K the compliance of gear, bearing and shaft. The torque that acts is
//! τ(q + δ e_j) = τ(q) + c (τ(q + δ e_j) − τ(q)) / a for c = a, and to first order for a c near a; for a = 0 the quotient is
//! −τ_j ∂τ/∂q_j. The change of a load of 100 Nm on 10⁴ Nm/rad, of which a tenth of a radian takes 10 Nm, is 1 Nm.
//!
//! # Far below the resonance
//! Velocity and acceleration are those of the motor: M_j δ̈ is left out, which is (ω/ω₀)² of the load's part of the frequency ω on a
//! resonance of ω₀. `joint_elasticity` of the simulator has both.
//!
//! # Linear only around known bodies
//! The product of compliance and inertial parameters is not linear. As in `base_tilt`, the inertial values are configuration:
//! standard-parameter indices and values of a fit. Without them all columns are zero, and a calibration reports the compliances as not
//! excited.
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `joints` | – | joints that give way; all unless given |
//! | `around_rad_nm` | rad/Nm | a, one for each of the joints; zeros unless given |
//! | `inertial_columns` | – | indices of standard inertial parameters, ten per link; empty unless given |
//! | `inertial_values` | as those | their values |
//!
//! # Columns
//! | name | unit | column |
//! |---|---|---|
//! | `joint_compliance_<j>` | rad/Nm | (τ(q + δ e_j) − τ(q)) / a, on all joints |
//!
//! # Use when
//! Gears, belts or bearings are soft beside the loads that they carry and the arm moves slowly: strain-wave gears under long levers, cable
//! drives, large arms. A joint that turns about the direction of gravity and carries all others does not show it.
//!
//! # Source
//! Spong (1987), *Modeling and control of elastic joint robots*, at rest; for the practice, Dumas et al. (2011), *Joint stiffness
//! identification of six-revolute industrial serial robots*.
//!
//! # Invariants
//! Even in load, continuous in velocity, memoryless. The term is a load.

use aurt_traits::{ArmSeries, ArmTerm, Columns, ModelError, Parameter, Result, register_model};
use serde::{Deserialize, Serialize};

use crate::arm_terms::joint_selection::JointSelection;
use crate::known_bodies::{KnownBodies, STEP_RAD, torque, turned};
use crate::shape::verdict;

/// A joint that gives way under its load.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct JointCompliance {
    /// Joints that give way.
    #[serde(skip_serializing_if = "JointSelection::is_all")]
    pub joints: JointSelection,
    /// The compliances for which the torque is exact, one for each joint; zeros where empty.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub around_rad_nm: Vec<f64>,
    /// Indices of the standard inertial parameters whose values are known.
    pub inertial_columns: Vec<usize>,
    /// Their values.
    pub inertial_values: Vec<f64>,
}

/// Evaluations of the deflection under the load that it changes: each leaves the share c ∂τ_j/∂q_j of the error of the one before, a
/// twentieth of gears that give way by five per cent of the lever.
const ROUNDS: usize = 3;

impl JointCompliance {
    fn bodies(&self) -> KnownBodies<'_> {
        KnownBodies {
            model: "joint_compliance",
            columns: &self.inertial_columns,
            values: &self.inertial_values,
        }
    }
}

register_model! {
    slot: ArmTerm,
    name: "joint_compliance",
    summary: "a joint that gives way under its load",
    equation: "τ = Σ_j joint_compliance_j (τ_RBD(q + δ e_j) − τ_RBD(q)) / a, δ = −a τ_RBD,j, −τ_RBD,j ∂τ_RBD/∂q_j for a = 0, τ_RBD of a fit",
    use_when: "gears are soft beside the loads and the arm moves far below their resonances; hold the calibrated coefficients fixed",
    source: "Spong (1987) at rest; Dumas et al. (2011)",
    example: r#"{ model = "joint_compliance", joints = [1], inertial_columns = [6, 9, 16, 19], inertial_values = [0.9, 3.0, 0.4, 2.0] }"#,
}

#[typetag::serde(name = "joint_compliance")]
impl ArmTerm for JointCompliance {
    declares_term! {
        "joint_compliance",
        invariants: [EvenInLoad, ContinuousInVelocity, Memoryless]
    }

    fn joints(&self, robot_joints: usize) -> Vec<usize> {
        (0..robot_joints).collect()
    }

    fn columns(&self, robot_joints: usize) -> Vec<Parameter> {
        let name = |j: usize| Parameter::new(format!("joint_compliance_{j}"), "rad/Nm");
        self.joints.resolve(robot_joints).into_iter().map(name).collect()
    }

    fn is_load(&self) -> bool {
        true
    }

    fn validate(&self, robot_joints: usize) -> Result<(), Vec<ModelError>> {
        let mut complaints = self.joints.complaints("joint_compliance", robot_joints);
        complaints.extend(self.bodies().complaints());
        let joints = self.joints.resolve(robot_joints).len();
        complaints.extend(self.bodies().around_complaints("around_rad_nm", &self.around_rad_nm, joints));
        verdict(complaints)
    }

    /// One variable, the number of the rigid body's standard parameters, which is asked for once per series.
    fn state_len(&self, _robot_joints: usize) -> usize {
        1
    }

    fn initial_state(&self, first: &ArmSeries<'_>) -> Vec<f64> {
        vec![first.rigid_body.standard_parameters().len() as f64]
    }

    fn evaluate(&self, series: &ArmSeries<'_>, state: &mut [f64], out: &mut Columns<'_>) -> Result {
        let (view, standard) = (series.motion, self.bodies().standard(state[0] as usize)?);
        let (joints, samples) = (view.joints(), view.samples());
        let own = self.joints.resolve(joints);
        let is_known = samples > 0 && standard.iter().any(|value| *value != 0.0);
        let shown =
            if is_known { torque(series.rigid_body, view, &standard) } else { vec![0.0; joints * samples] };
        for (k, joint) in own.iter().enumerate() {
            let around = self.around_rad_nm.get(k).copied().unwrap_or(0.0);
            let slope =
                if is_known { slope(series, &standard, (*joint, around), &shown)? } else { shown.clone() };
            for row in 0..joints {
                out.column_mut(row * own.len() + k)
                    .copy_from_slice(&slope[row * samples..(row + 1) * samples]);
            }
        }
        Ok(())
    }
}

/// The torque's change per compliance, from the torque at the angles of the motors.
fn slope(
    series: &ArmSeries<'_>,
    standard: &[f64],
    (joint, around): (usize, f64),
    shown: &[f64],
) -> Result<Vec<f64>> {
    let samples = series.motion.samples();
    let own = joint * samples..(joint + 1) * samples;
    let largest = shown[own.clone()].iter().fold(0.0_f64, |most, load| most.max(load.abs()));
    if around.abs() * largest < STEP_RAD {
        let [ahead, behind] = [STEP_RAD, -STEP_RAD].map(|by| turned(series, standard, joint, |_| by));
        let slopes = ahead?.into_iter().zip(behind?).map(|(a, b)| (a - b) / (2.0 * STEP_RAD));
        return Ok(slopes.enumerate().map(|(k, slope)| -slope * shown[own.start + k % samples]).collect());
    }
    let mut moved = shown.to_vec();
    for _ in 0..ROUNDS {
        let load = moved[own.clone()].to_vec();
        moved = turned(series, standard, joint, |k| -around * load[k])?;
    }
    Ok(moved.iter().zip(shown).map(|(moved, shown)| (moved - shown) / around).collect())
}
