use nalgebra::{Matrix3, Vector3};

use crate::dynamics::link_place;
use crate::{JointKind, SerialChain};

/// Where a link frame is, in the base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkFrame {
    /// Rotation matrix, row after row; it maps coordinates in the link frame to the base frame.
    pub rotation: [[f64; 3]; 3],
    /// The frame's origin in m.
    pub origin_m: [f64; 3],
}

impl LinkFrame {
    /// A point of the link, in the base frame.
    pub fn point_m(&self, in_link_m: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|r| {
            self.origin_m[r] + (0..3).map(|c| self.rotation[r][c] * in_link_m[c]).sum::<f64>()
        })
    }
}

impl SerialChain {
    /// The frames of all links, in the order of their joints, at the joint angles q; `frames` is cleared first.
    ///
    /// # Panics
    /// If `q_rad` does not have N entries.
    pub fn link_frames(&self, q_rad: &[f64], frames: &mut Vec<LinkFrame>) {
        assert_eq!(q_rad.len(), self.joints().len(), "joint angles");
        frames.clear();
        for (i, ((frame, joint), q)) in self.frames().iter().zip(self.joints()).zip(q_rad).enumerate() {
            let (link_rotation, link_origin) = link_place(frame, joint, *q);
            let (mut rotation, mut origin) = (Matrix3::identity(), Vector3::zeros());
            if let Some(parent) = self.parent(i).map(|parent| &frames[parent]) {
                rotation = Matrix3::from(parent.rotation).transpose();
                origin = parent.origin_m.into();
            }
            origin += rotation * link_origin;
            rotation *= link_rotation;
            frames.push(LinkFrame { rotation: rotation.transpose().into(), origin_m: origin.into() });
        }
    }

    /// The geometric Jacobian of a point of `link`, 6 × N, row after row, in the base frame: rows 0–2 give
    /// the point's velocity in m/s, rows 3–5 the link's angular velocity in rad/s, per q̇.
    ///
    /// A force F and a moment M that act on the link at that point load the joints with Jᵀ (F, M).
    ///
    /// `frames` are those of [`Self::link_frames`]; `point_m` is in the link frame.
    ///
    /// # Panics
    /// If `link` is not below N, `frames` does not have N entries or `jacobian` 6 N.
    pub fn jacobian(&self, frames: &[LinkFrame], link: usize, point_m: [f64; 3], jacobian: &mut [f64]) {
        let joints = self.joints().len();
        assert_eq!(frames.len(), joints, "link frames");
        assert_eq!(jacobian.len(), 6 * joints, "entries of the Jacobian");
        let point = Vector3::from(frames[link].point_m(point_m));
        jacobian.fill(0.0);
        for j in self.path(link).iter().copied() {
            let (frame, joint) = (&frames[j], &self.joints()[j]);
            let axis = Vector3::from_fn(|r, _| joint.sign * frame.rotation[r][2]);
            let (velocity, spin) = match joint.kind {
                JointKind::Revolute => (axis.cross(&(point - Vector3::from(frame.origin_m))), axis),
                JointKind::Prismatic => (axis, Vector3::zeros()),
            };
            for r in 0..3 {
                jacobian[r * joints + j] = velocity[r];
                jacobian[(3 + r) * joints + j] = spin[r];
            }
        }
    }
}
