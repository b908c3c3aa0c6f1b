//! The joint controller: feed-forward of the nominal model and a proportional–derivative loop on the shafts.

use aurt_rbd::ChainDynamics;
use serde::{Deserialize, Serialize};

use crate::error::{Complaints, SimulationError};
use crate::robots::Robot;
use crate::trajectory::Trajectory;

/// How the joints are driven.
///
/// The controller works in continuous time and sees the shafts without noise; what it commands is what the
/// motors deliver, within the limits of torque and of its rate:
/// u = τ_nominal(q_d, q̇_d, q̈_d) + friction_nominal(q̇_d) + K_p (q_d − θ) + K_d (q̇_d − θ̇).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Controller {
    /// Bandwidth of the loop, Hz: K_p = I ω², K_d = 2 ζ I ω with the joint's nominal inertia I at home, the
    /// other joints free.
    pub bandwidth_hz: f64,
    pub damping_ratio: f64,
    /// Share of the nominal rigid-body torque that is fed forward, 0–1.
    pub feed_forward: f64,
    /// Share of the nominal friction that is fed forward, 0–1.
    pub friction_feed_forward: f64,
    /// Commanded velocity around which the fed-forward friction changes its sign, rad/s.
    pub friction_width_rad_s: f64,
}

impl Default for Controller {
    fn default() -> Self {
        Self {
            bandwidth_hz: 25.0,
            damping_ratio: 0.9,
            feed_forward: 1.0,
            friction_feed_forward: 1.0,
            friction_width_rad_s: 5e-4,
        }
    }
}

impl Controller {
    /// Checks that the gains make sense.
    pub fn validate(&self) -> Result<(), SimulationError> {
        let mut complaints = Complaints::default();
        complaints.within("controller bandwidth in Hz", self.bandwidth_hz, 0.1, 60.0);
        complaints.within("controller damping ratio", self.damping_ratio, 0.1, 5.0);
        complaints.within("share of feed-forward", self.feed_forward, 0.0, 1.0);
        complaints.within("share of friction feed-forward", self.friction_feed_forward, 0.0, 1.0);
        complaints.positive("width of the friction feed-forward in rad/s", self.friction_width_rad_s);
        complaints.finish()
    }
}

/// The commanded motion and torque as a table of time, and the gains.
#[derive(Debug, Clone)]
pub(crate) struct TrackingLoop {
    joints: usize,
    step_s: f64,
    /// Node after node, joint after joint: angle, velocity, acceleration, torque without dry friction.
    nodes: Vec<[f64; 4]>,
    proportional_nm_rad: Vec<f64>,
    derivative_nm_s: Vec<f64>,
    coulomb_nm: Vec<f64>,
    friction_width_rad_s: f64,
    torque_limit_nm: Vec<f64>,
    rate_limit_nm_s: Vec<f64>,
}

impl TrackingLoop {
    pub fn new(
        controller: &Controller,
        nominal: &Robot,
        trajectory: &Trajectory,
        step_s: f64,
    ) -> Result<Self, SimulationError> {
        let joints = nominal.joints();
        let rotors: Vec<f64> = nominal.drives.iter().map(|d| d.rotor_inertia_kg_m2).collect();
        let mut dynamics = ChainDynamics::new(nominal.chain()?, &nominal.standard_parameters())?
            .with_rotor_inertia(&rotors)?;
        let home: Vec<f64> = nominal.drives.iter().map(|d| d.home_rad).collect();
        let mut mass = vec![0.0; joints * joints];
        dynamics.mass_matrix(&home, &mut mass);
        let omega = std::f64::consts::TAU * controller.bandwidth_hz;
        let inverse =
            nalgebra::DMatrix::from_row_slice(joints, joints, &mass).cholesky().map(|f| f.inverse());
        let inertia = |j: usize| inverse.as_ref().map_or(mass[j * joints + j], |m| 1.0 / m[(j, j)]);

        let count = (trajectory.duration_s() / step_s) as usize + 3;
        let mut nodes = Vec::with_capacity(count * joints);
        let (mut q, mut qd, mut qdd) = (vec![0.0; joints], vec![0.0; joints], vec![0.0; joints]);
        let mut torque = vec![0.0; joints];
        for k in 0..count {
            trajectory.at(k as f64 * step_s, &mut q, &mut qd, &mut qdd);
            dynamics.inverse_dynamics(&q, &qd, &qdd, &mut torque);
            for (j, drive) in nominal.drives.iter().enumerate() {
                let viscous = controller.friction_feed_forward * drive.viscous_nm_s * qd[j];
                nodes.push([q[j], qd[j], qdd[j], controller.feed_forward * torque[j] + viscous]);
            }
        }
        Ok(Self {
            joints,
            step_s,
            nodes,
            proportional_nm_rad: (0..joints).map(|j| inertia(j) * omega * omega).collect(),
            derivative_nm_s: (0..joints)
                .map(|j| 2.0 * controller.damping_ratio * inertia(j) * omega)
                .collect(),
            coulomb_nm: nominal
                .drives
                .iter()
                .map(|d| controller.friction_feed_forward * d.coulomb_nm)
                .collect(),
            friction_width_rad_s: controller.friction_width_rad_s,
            torque_limit_nm: nominal.drives.iter().map(|d| d.torque_limit_nm).collect(),
            rate_limit_nm_s: nominal.drives.iter().map(|d| d.torque_rate_limit_nm_s).collect(),
        })
    }

    /// Writes the drives' torques at `time_s`; `since` is the torque at an earlier time and how long ago
    /// that was, for the limit of the rate.
    pub fn torque_nm(
        &self,
        time_s: f64,
        shaft_rad: &[f64],
        shaft_rad_s: &[f64],
        since: (&[f64], f64),
        torque_nm: &mut [f64],
    ) {
        let position = (time_s / self.step_s).max(0.0);
        let node = (position as usize).min(self.nodes.len() / self.joints - 2);
        let x = (position - node as f64).min(1.0);
        let here = &self.nodes[node * self.joints..(node + 1) * self.joints];
        let next = &self.nodes[(node + 1) * self.joints..(node + 2) * self.joints];
        for j in 0..self.joints {
            let ([q0, v0, a0, u0], [q1, v1, a1, u1]) = (here[j], next[j]);
            let q = hermite(x, self.step_s, (q0, v0), (q1, v1));
            let v = hermite(x, self.step_s, (v0, a0), (v1, a1));
            let slow = v / self.friction_width_rad_s;
            let friction = self.coulomb_nm[j] * slow / (1.0 + slow * slow).sqrt();
            let wanted = u0
                + x * (u1 - u0)
                + friction
                + self.proportional_nm_rad[j] * (q - shaft_rad[j])
                + self.derivative_nm_s[j] * (v - shaft_rad_s[j]);
            let (before, elapsed_s) = (since.0[j], since.1);
            let step = self.rate_limit_nm_s[j] * elapsed_s;
            let limit = self.torque_limit_nm[j];
            torque_nm[j] = wanted.clamp(before - step, before + step).clamp(-limit, limit);
        }
    }

    pub fn command_rad(&self, time_s: f64, joint: usize) -> f64 {
        let node = ((time_s / self.step_s).round() as usize).min(self.nodes.len() / self.joints - 1);
        self.nodes[node * self.joints + joint][0]
    }

    pub fn start_rad(&self) -> Vec<f64> {
        self.nodes[..self.joints].iter().map(|n| n[0]).collect()
    }

    /// The fastest rate of the loop on a shaft of inertia `inertia_kg_m2`, 1/s.
    pub fn rate_per_s(&self, joint: usize, inertia_kg_m2: f64) -> f64 {
        (self.proportional_nm_rad[joint] / inertia_kg_m2)
            .sqrt()
            .max(self.derivative_nm_s[joint] / inertia_kg_m2)
    }
}

/// The cubic through two values with the given slopes, at the share `x` of the distance `h`.
fn hermite(x: f64, h: f64, (y0, d0): (f64, f64), (y1, d1): (f64, f64)) -> f64 {
    let x2 = x * x;
    let rise = x2 * (3.0 - 2.0 * x);
    let y = 1.0 - x;
    y0 + (y1 - y0) * rise + h * (d0 * x * y * y - d1 * x2 * y)
}
