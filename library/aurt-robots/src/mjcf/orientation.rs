//! The six ways in which MJCF writes an orientation.

use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};

use crate::RobotError;
use crate::element::Element;
use crate::pose::Pose;

/// What `<compiler>` says of angles.
#[derive(Debug, Clone, Copy)]
pub(super) struct Angles {
    /// An angle's unit in rad.
    pub unit_rad: f64,
    /// The axes of `euler` in their order, from 0, and whether each is fixed (else it turns with the frame).
    pub euler: [(usize, bool); 3],
}

impl Angles {
    /// MuJoCo's defaults: degrees, x y z that turn with the frame.
    pub const DEFAULT: Self =
        Self { unit_rad: std::f64::consts::PI / 180.0, euler: [(0, false), (1, false), (2, false)] };

    /// The order of `eulerseq`, such as `xyz` (turning axes) or `XYZ` (fixed axes).
    pub fn order(text: &str) -> Option<[(usize, bool); 3]> {
        let axes: Option<Vec<(usize, bool)>> = text
            .chars()
            .map(|c| {
                Some((['x', 'y', 'z'].iter().position(|a| *a == c.to_ascii_lowercase())?, c.is_uppercase()))
            })
            .collect();
        axes?.try_into().ok()
    }

    /// The `pos` and the orientation of an element.
    pub fn pose(&self, element: &Element<'_, '_>) -> Result<Pose, RobotError> {
        let position = element.numbers::<3>("pos")?.unwrap_or_default();
        Ok(Pose { rotation: self.rotation(element)?, origin_m: position.into() })
    }

    fn rotation(&self, element: &Element<'_, '_>) -> Result<Matrix3<f64>, RobotError> {
        const WAYS: [&str; 5] = ["quat", "axisangle", "euler", "xyaxes", "zaxis"];
        let given: Vec<&str> = WAYS.into_iter().filter(|way| element.node.has_attribute(*way)).collect();
        if let [first, second, ..] = given[..] {
            return Err(element.error(format!("`{first}` and `{second}` are two orientations; remove one")));
        }
        let direction = |way: &str, v: Vector3<f64>| {
            if v.norm() < 1e-10 {
                Err(element.error(format!("`{way}` has no direction")))
            } else {
                Ok(v.normalize())
            }
        };
        if let Some([w, x, y, z]) = element.numbers("quat")? {
            let quaternion = Quaternion::new(w, x, y, z);
            if quaternion.norm() < 1e-10 {
                return Err(element.error("`quat` is zero; it is w x y z of a rotation"));
            }
            return Ok(UnitQuaternion::from_quaternion(quaternion).to_rotation_matrix().into_inner());
        }
        if let Some([x, y, z, angle]) = element.numbers("axisangle")? {
            let axis = direction("axisangle", Vector3::new(x, y, z))?;
            return Ok(Rotation3::new(axis * angle * self.unit_rad).into_inner());
        }
        if let Some(angles) = element.numbers::<3>("euler")? {
            let mut rotation = Rotation3::identity();
            for ((axis, fixed), angle) in self.euler.into_iter().zip(angles) {
                let mut vector = Vector3::zeros();
                vector[axis] = angle * self.unit_rad;
                let turn = Rotation3::new(vector);
                rotation = if fixed { turn * rotation } else { rotation * turn };
            }
            return Ok(rotation.into_inner());
        }
        if let Some([a, b, c, d, e, f]) = element.numbers("xyaxes")? {
            let x = direction("xyaxes", Vector3::new(a, b, c))?;
            let y = Vector3::new(d, e, f);
            let y = direction("xyaxes", y - x * x.dot(&y))?;
            return Ok(Matrix3::from_columns(&[x, y, x.cross(&y)]));
        }
        if let Some(z) = element.numbers::<3>("zaxis")? {
            // The smallest rotation that takes z there; of the opposite direction half a turn about x.
            let z = direction("zaxis", z.into())?;
            let turn = Rotation3::rotation_between(&Vector3::z(), &z);
            return Ok(turn
                .unwrap_or_else(|| Rotation3::new(Vector3::x() * std::f64::consts::PI))
                .into_inner());
        }
        Ok(Matrix3::identity())
    }
}
