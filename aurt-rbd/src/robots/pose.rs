use crate::Placement;
use nalgebra::{Matrix3, Vector3};

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
        Self {
            rotation: Matrix3::from_fn(|row, column| rotation[row][column]),
            origin_m: translation_m.into(),
        }
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
        Placement::Fixed {
            rotation: std::array::from_fn(|row| std::array::from_fn(|column| self.rotation[(row, column)])),
            translation_m: self.origin_m.into(),
        }
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
