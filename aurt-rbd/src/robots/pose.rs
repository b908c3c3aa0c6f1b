use nalgebra::{Matrix3, Vector3};

use crate::{INERTIAL_PARAMETERS, LinkBody, Placement};

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pose {
    /// Maps coordinates in the frame to the other.
    pub rotation: Matrix3<f64>,
    /// The frame's origin in the other, in m.
    pub origin_m: Vector3<f64>,
}

impl Pose {
    /// The same frame.
    pub fn identity() -> Self {
        Self { rotation: Matrix3::identity(), origin_m: Vector3::zeros() }
    }

    /// A frame of the same origin.
    pub fn turned(rotation: Matrix3<f64>) -> Self {
        Self { rotation, origin_m: Vector3::zeros() }
    }

    /// The pose of a placement.
    pub fn of(placement: Placement) -> Self {
        let Placement::Fixed { rotation, translation_m } = placement else { return Self::identity() };
        Self { rotation: Matrix3::from(rotation).transpose(), origin_m: translation_m.into() }
    }

    /// The pose of a frame that is `next` in this frame.
    pub fn then(&self, next: &Self) -> Self {
        Self {
            rotation: self.rotation * next.rotation,
            origin_m: self.origin_m + self.rotation * next.origin_m,
        }
    }

    /// The pose as a joint's constant placement.
    pub fn placement(&self) -> Placement {
        Placement::Fixed { rotation: self.rotation.transpose().into(), translation_m: self.origin_m.into() }
    }
}

/// The frame whose z axis is along `axis` (of any length but zero), in the frame that the axis is given in, and whether
/// the axis is its negative z: an axis along −x, −y or −z shares the frame of its opposite.
pub(crate) fn along(axis: &Vector3<f64>) -> (Matrix3<f64>, f64) {
    let unit = |k: usize| Vector3::from_fn(|row, _| if row == k { 1.0 } else { 0.0 });
    for k in 0..3 {
        if axis[(k + 1) % 3] == 0.0 && axis[(k + 2) % 3] == 0.0 {
            let frame = Matrix3::from_columns(&[unit((k + 1) % 3), unit((k + 2) % 3), unit(k)]);
            return (frame, axis[k].signum());
        }
    }
    let z = axis.normalize();
    // The coordinate axis that is farthest from z gives a well-conditioned x.
    let x = unit(z.iamin());
    let x = (x - z * z.dot(&x)).normalize();
    (Matrix3::from_columns(&[x, z.cross(&x), z]), 1.0)
}

/// A mass distribution in the frame of the link that it belongs to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Body {
    pub mass_kg: f64,
    /// The frame at the centre of mass whose axes the inertia is given along.
    pub pose: Pose,
    /// Inertia about the centre of mass, in kg m².
    pub inertia_kg_m2: Matrix3<f64>,
}

impl Body {
    /// Several bodies as one, by the parallel-axis theorem: I = Σ (R I_k Rᵀ + m_k (|d_k|² 1 − d_k d_kᵀ)), about the common centre
    /// of mass and along the axes of the link.
    pub fn of_parts(parts: &[Self]) -> Self {
        let mass_kg: f64 = parts.iter().map(|part| part.mass_kg).sum();
        let moment: Vector3<f64> = parts.iter().map(|part| part.pose.origin_m * part.mass_kg).sum();
        let com = moment / mass_kg;
        let inertia_kg_m2 = parts.iter().map(|part| {
            let (turn, from) = (part.pose.rotation, part.pose.origin_m - com);
            let displaced = Matrix3::identity() * from.norm_squared() - from * from.transpose();
            turn * part.inertia_kg_m2 * turn.transpose() + displaced * part.mass_kg
        });
        let inertia_kg_m2 = inertia_kg_m2.sum();
        Self { mass_kg, pose: Pose { origin_m: com, ..Pose::identity() }, inertia_kg_m2 }
    }

    /// The ten standard parameters of the body in a frame in which its link is at `link`.
    pub fn standard_parameters(&self, link: &Pose) -> [f64; INERTIAL_PARAMETERS] {
        let pose = link.then(&self.pose);
        let inertia = pose.rotation * self.inertia_kg_m2 * pose.rotation.transpose();
        let com: Vector3<f64> = pose.origin_m;
        LinkBody {
            mass_kg: self.mass_kg,
            com_m: com.into(),
            inertia_at_com_kg_m2: [
                inertia[(0, 0)],
                inertia[(0, 1)],
                inertia[(0, 2)],
                inertia[(1, 1)],
                inertia[(1, 2)],
                inertia[(2, 2)],
            ],
        }
        .standard_parameters()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_along_axes_are_right_handed() {
        for axis in [[0.0, 0.0, 2.0], [0.0, -1.0, 0.0], [-3.0, 0.0, 0.0], [0.0, 0.6, 0.8], [1.0, -2.0, 0.5]] {
            let axis = Vector3::from(axis);
            let (frame, sign) = along(&axis);
            assert!((frame.determinant() - 1.0).abs() < 1e-15, "{axis}");
            assert!((frame * frame.transpose() - Matrix3::identity()).norm() < 1e-15, "{axis}");
            assert!((frame.column(2) * sign - axis.normalize()).norm() < 1e-15, "{axis}");
        }
        assert_eq!(along(&Vector3::z()), (Matrix3::identity(), 1.0));
    }
}
