use nalgebra::Vector3;

use crate::dynamics::{Articulated, joint_velocity, on_axis};
use crate::{ChainDynamics, Parent};

impl ChainDynamics {
    /// Joint accelerations q̈ in rad/s² under the torques τ, by the articulated-body algorithm
    /// (Featherstone, *Rigid Body Dynamics Algorithms*, section 7.3).
    ///
    /// Torques of contacts come in as part of τ (Jᵀ F, [`crate::SerialChain::jacobian`]). A joint whose
    /// articulated inertia is not positive (a chain without mass beyond it) gives values that are not
    /// finite.
    ///
    /// # Panics
    /// If a slice does not have N entries.
    pub fn forward_dynamics(
        &mut self,
        q_rad: &[f64],
        qd_rad_s: &[f64],
        torque_nm: &[f64],
        qdd_rad_s2: &mut [f64],
    ) {
        let joints = self.joints();
        assert_eq!(qd_rad_s.len(), joints, "joint velocities");
        assert_eq!(torque_nm.len(), joints, "joint torques");
        assert_eq!(qdd_rad_s2.len(), joints, "joint accelerations");
        self.place(q_rad);
        self.velocities_and_bias_forces(qd_rad_s);
        self.articulate(torque_nm);

        let base = [Vector3::zeros(), -Vector3::from(self.chain.gravity_m_s2()), Vector3::zeros()];
        let [mut angular, mut linear, _] = base;
        let (joints, places, scratch) = (self.chain.joints(), self.chain.places(), &mut self.scratch[..]);
        for (i, ((joint, place), qdd)) in joints.iter().zip(places).zip(qdd_rad_s2).enumerate() {
            if joint.parent != Parent::Previous {
                [angular, linear, _] = joint.parent.of(i).map_or(base, |parent| scratch[parent].motion);
            }
            let link = &mut scratch[i];
            let into = link.rotation.transpose();
            linear = into * (linear + angular.cross(&link.origin)) + link.bias_linear;
            angular = into * angular + link.bias_angular;
            let carried = link.axis_moment.dot(&angular) + link.axis_force.dot(&linear);
            let rate_dot = (link.axis_torque - carried) / link.axis_inertia;
            let (turning, sliding) = joint_velocity(joint.kind, rate_dot);
            angular += turning;
            linear += sliding;
            if place.branching.kept.is_some() {
                link.motion = [angular, linear, Vector3::zeros()];
            }
            *qdd = joint.sign * rate_dot;
        }
    }

    /// Outward: spatial velocities, velocity-product accelerations, bias forces and the links' inertias.
    fn velocities_and_bias_forces(&mut self, qd_rad_s: &[f64]) {
        let base = [Vector3::zeros(); 3];
        let [mut angular, mut linear, _] = base;
        let (joints, places, scratch) = (self.chain.joints(), self.chain.places(), &mut self.scratch[..]);
        for (i, ((body, joint), place)) in self.links.iter().zip(joints).zip(places).enumerate() {
            if joint.parent != Parent::Previous {
                [angular, linear, _] = joint.parent.of(i).map_or(base, |parent| scratch[parent].motion);
            }
            let link = &mut scratch[i];
            let (turning, sliding) = joint_velocity(joint.kind, joint.sign * qd_rad_s[i]);
            let into = link.rotation.transpose();
            linear = into * (linear + angular.cross(&link.origin)) + sliding;
            angular = into * angular + turning;
            if place.branching.kept.is_some() {
                link.motion = [angular, linear, Vector3::zeros()];
            }
            link.bias_angular = angular.cross(&turning);
            link.bias_linear = linear.cross(&turning) + angular.cross(&sliding);
            let h = &body.first_moment;
            let angular_momentum = body.inertia * angular + h.cross(&linear);
            let momentum = body.mass * linear - h.cross(&angular);
            link.moment = angular.cross(&angular_momentum) + linear.cross(&momentum);
            link.force = angular.cross(&momentum);
            link.articulated = body.articulated();
        }
    }

    /// Inward: articulated inertias and bias forces, each joint's share taken out.
    fn articulate(&mut self, torque_nm: &[f64]) {
        let (joints, scratch) = (self.chain.joints(), &mut self.scratch[..]);
        for (i, joint) in joints.iter().enumerate().rev() {
            let link = &mut scratch[i];
            let Articulated { j, h, m } = link.articulated;
            let (axis_moment, axis_force) = link.articulated.along_axis(joint.kind);
            link.axis_moment = axis_moment;
            link.axis_force = axis_force;
            link.axis_inertia = on_axis(joint.kind, &axis_moment, &axis_force) + self.rotor_inertia_kg_m2[i];
            link.axis_torque = joint.sign * torque_nm[i] - on_axis(joint.kind, &link.moment, &link.force);
            let Some(parent) = joint.parent.of(i) else { continue };
            let inverse = 1.0 / link.axis_inertia;
            let passed_on = Articulated {
                j: j - axis_moment * axis_moment.transpose() * inverse,
                h: h - axis_moment * axis_force.transpose() * inverse,
                m: m - axis_force * axis_force.transpose() * inverse,
            };
            let drive = link.axis_torque * inverse;
            let (ba, bl) = (link.bias_angular, link.bias_linear);
            let moment = link.moment + passed_on.j * ba + passed_on.h * bl + axis_moment * drive;
            let force = link.force + passed_on.h.transpose() * ba + passed_on.m * bl + axis_force * drive;
            let (rotation, origin) = (link.rotation, link.origin);
            let carried = passed_on.in_previous(&rotation, &origin);
            let force = rotation * force;
            let previous = &mut scratch[parent];
            previous.articulated.j += carried.j;
            previous.articulated.h += carried.h;
            previous.articulated.m += carried.m;
            previous.moment += rotation * moment + origin.cross(&force);
            previous.force += force;
        }
    }
}
