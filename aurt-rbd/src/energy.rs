use nalgebra::{Matrix3, Vector3};

use crate::ChainDynamics;
use crate::dynamics::joint_velocity;

/// Mechanical energy of a robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Energy {
    /// Kinetic energy in J, that of the rotors included.
    pub kinetic_j: f64,
    /// Potential energy in J, zero if every centre of mass is at the height of the base frame's origin.
    pub potential_j: f64,
}

impl Energy {
    /// The sum of both, in J.
    pub fn total_j(&self) -> f64 {
        self.kinetic_j + self.potential_j
    }
}

impl ChainDynamics {
    /// Kinetic energy ½ Σ (ω·Iω + m v·v + 2 v·(ω × h)) + ½ Σ I_a q̇² and potential energy −Σ g·(m p + R h).
    ///
    /// # Panics
    /// If a slice does not have N entries.
    pub fn energy(&mut self, q_rad: &[f64], qd_rad_s: &[f64]) -> Energy {
        assert_eq!(qd_rad_s.len(), self.joints(), "joint velocities");
        self.place(q_rad);
        let gravity = Vector3::from(self.chain.gravity_m_s2());
        let mut energy = Energy { kinetic_j: 0.0, potential_j: 0.0 };
        for (i, body) in self.links.iter().enumerate() {
            let parent = self.chain.parent(i);
            let [mut omega, mut velocity, mut origin] =
                parent.map_or([Vector3::zeros(); 3], |p| self.scratch[p].motion);
            let mut rotation = parent.map_or(Matrix3::identity(), |p| self.scratch[p].in_base);
            let (link, joint) = (&mut self.scratch[i], &self.chain.joints()[i]);
            let into = link.rotation.transpose();
            let (turning, sliding) = joint_velocity(joint.kind, joint.sign * qd_rad_s[i]);
            velocity = into * (velocity + omega.cross(&link.origin)) + sliding;
            omega = into * omega + turning;
            origin += rotation * link.origin;
            rotation *= link.rotation;
            link.motion = [omega, velocity, origin];
            link.in_base = rotation;
            let h = &body.first_moment;
            energy.kinetic_j += 0.5
                * (omega.dot(&(body.inertia * omega))
                    + body.mass * velocity.norm_squared()
                    + self.rotor_inertia_kg_m2[i] * qd_rad_s[i].powi(2))
                + velocity.dot(&omega.cross(h));
            energy.potential_j -= gravity.dot(&(body.mass * origin + rotation * h));
        }
        energy
    }
}
