use nalgebra::Vector3;

use crate::dynamics::{LinkScratch, on_axis};
use crate::{ChainDynamics, JointKind, Parent};

impl ChainDynamics {
    /// Joint torques τ(q, q̇, q̈) in Nm, by the recursive Newton–Euler algorithm (Luh, Walker, Paul, 1980).
    ///
    /// Outward, each link frame's ω, ω̇ and origin acceleration a (less gravity) follow from those of its
    /// parent's; each link needs the force m a + ω̇ × h + ω × (ω × h) and the moment I ω̇ + ω × I ω + h × a about
    /// its origin. Inward, forces and moments add up, and a revolute joint carries their moment about its axis, a
    /// prismatic one their force along it.
    ///
    /// # Panics
    /// If a slice does not have N entries.
    pub fn inverse_dynamics(
        &mut self,
        q_rad: &[f64],
        qd_rad_s: &[f64],
        qdd_rad_s2: &[f64],
        torque_nm: &mut [f64],
    ) {
        assert_eq!(qdd_rad_s2.len(), self.joints(), "joint accelerations");
        self.newton_euler(q_rad, qd_rad_s, |joint| qdd_rad_s2[joint], torque_nm);
    }

    /// Torques in Nm that hold the motion (q, q̇) at q̈ = 0: Coriolis, centrifugal and gravity torques.
    ///
    /// # Panics
    /// If a slice does not have N entries.
    pub fn bias_torque(&mut self, q_rad: &[f64], qd_rad_s: &[f64], torque_nm: &mut [f64]) {
        self.newton_euler(q_rad, qd_rad_s, |_| 0.0, torque_nm);
    }

    fn newton_euler(
        &mut self,
        q_rad: &[f64],
        qd_rad_s: &[f64],
        qdd_rad_s2: impl Fn(usize) -> f64,
        torque_nm: &mut [f64],
    ) {
        assert_eq!(qd_rad_s.len(), self.joints(), "joint velocities");
        assert_eq!(torque_nm.len(), self.joints(), "joint torques");
        self.place(q_rad);
        let axis = Vector3::z();
        let base = [Vector3::zeros(), Vector3::zeros(), -Vector3::from(self.chain.gravity_m_s2())];
        let [mut omega, mut omega_dot, mut accel] = base;
        let (joints, places, scratch) = (self.chain.joints(), self.chain.places(), &mut self.scratch[..]);
        for (i, ((body, joint), place)) in self.links.iter().zip(joints).zip(places).enumerate() {
            if joint.parent != Parent::Previous {
                [omega, omega_dot, accel] = joint.parent.of(i).map_or(base, |parent| scratch[parent].motion);
            }
            let link = &mut scratch[i];
            let (qd, qdd) = (joint.sign * qd_rad_s[i], joint.sign * qdd_rad_s2(i));
            let into = link.rotation.transpose();
            let r = &link.origin;
            accel = into * (accel + omega_dot.cross(r) + omega.cross(&omega.cross(r)));
            let carried = into * omega;
            match joint.kind {
                JointKind::Revolute => {
                    omega_dot = into * omega_dot + carried.cross(&(axis * qd)) + axis * qdd;
                    omega = carried + axis * qd;
                }
                JointKind::Prismatic => {
                    omega_dot = into * omega_dot;
                    omega = carried;
                    accel += 2.0 * omega.cross(&(axis * qd)) + axis * qdd;
                }
            }
            if place.branching.kept.is_some() {
                link.motion = [omega, omega_dot, accel];
            }
            let h = &body.first_moment;
            link.force = body.mass * accel + omega_dot.cross(h) + omega.cross(&omega.cross(h));
            link.moment = body.inertia * omega_dot + omega.cross(&(body.inertia * omega)) + h.cross(&accel);
        }
        for (i, joint) in joints.iter().enumerate().rev() {
            let LinkScratch { rotation, origin, moment, force, .. } = scratch[i];
            let rotor = self.rotor_inertia_kg_m2[i] * qdd_rad_s2(i);
            torque_nm[i] = joint.sign * on_axis(joint.kind, &moment, &force) + rotor;
            if let Some(parent) = joint.parent.of(i) {
                let force = rotation * force;
                let previous = &mut scratch[parent];
                previous.force += force;
                previous.moment += rotation * moment + origin.cross(&force);
            }
        }
    }
}
