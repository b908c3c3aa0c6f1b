use serde::{Deserialize, Serialize};

use crate::kernel::sine_cosine_of;
use crate::plausible::{angle_complaint, length_complaint};

/// What a joint does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum JointKind {
    /// It turns about its z axis; its coordinate is an angle in rad.
    #[default]
    Revolute,
    /// It slides along its z axis; its coordinate is a length in m.
    Prismatic,
}

impl JointKind {
    /// Every kind by the name that tables and files call it.
    pub const NAMES: [(&'static str, Self); 2] =
        [("revolute", Self::Revolute), ("prismatic", Self::Prismatic)];

    const fn is_revolute(&self) -> bool {
        matches!(self, Self::Revolute)
    }
}

/// The link that a joint sits on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Parent {
    /// The link of the joint before; the base for the first joint.
    #[default]
    Previous,
    /// The base.
    Base,
    /// The link of an earlier joint, from 0.
    Link(usize),
}

impl Parent {
    /// The link that `joint` sits on, `None` for the base.
    pub const fn of(self, joint: usize) -> Option<usize> {
        match self {
            Self::Previous => joint.checked_sub(1),
            Self::Base => None,
            Self::Link(link) => Some(link),
        }
    }

    /// The one name of `link` (`None` for the base) as the parent of `joint`.
    pub fn named(link: Option<usize>, joint: usize) -> Self {
        if link == Self::Previous.of(joint) { Self::Previous } else { link.map_or(Self::Base, Self::Link) }
    }

    fn is_previous(&self) -> bool {
        *self == Self::Previous
    }
}

/// A joint and where it sits on its parent link.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Joint {
    /// What the joint does. Files leave out `revolute`.
    #[serde(default, skip_serializing_if = "JointKind::is_revolute")]
    pub kind: JointKind,
    /// The link that the joint sits on. Files leave out `previous`.
    #[serde(default, skip_serializing_if = "Parent::is_previous")]
    pub parent: Parent,
    /// The constant transformation from the parent link's frame to the joint.
    pub placement: Placement,
    /// What is added to the joint's angle, in rad; the constant angle of a prismatic joint.
    #[serde(default)]
    pub theta_offset_rad: f64,
    /// Sense of the joint's coordinate, 1 or −1.
    #[serde(default = "positive")]
    pub sign: f64,
}

fn positive() -> f64 {
    1.0
}

/// A constant transformation between two frames.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Placement {
    /// Modified Denavit–Hartenberg: Rot_x(α) Trans_x(a) Trans_z(d).
    Mdh {
        /// Twist α in rad.
        alpha_rad: f64,
        /// Length a in m.
        a_m: f64,
        /// Offset d in m.
        d_m: f64,
    },
    /// A rotation and a translation.
    Fixed {
        /// Rotation matrix, row after row; it maps coordinates in the new frame to the old one.
        rotation: [[f64; 3]; 3],
        /// Origin of the new frame in the old one, in m.
        translation_m: [f64; 3],
    },
}

/// A [`Placement`] as numbers to calculate with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct JointFrame {
    /// Maps coordinates in the joint's frame (at joint angle 0; of a prismatic joint at its constant angle) to the
    /// parent link's frame.
    pub rotation: [[f64; 3]; 3],
    /// Origin of the joint's frame in the parent link's frame, in m.
    pub translation_m: [f64; 3],
}

impl Joint {
    /// A revolute joint at `placement` on the link of the joint before, whose angle is its coordinate.
    pub const fn revolute(placement: Placement) -> Self {
        let (kind, parent) = (JointKind::Revolute, Parent::Previous);
        Self { kind, parent, placement, theta_offset_rad: 0.0, sign: 1.0 }
    }

    /// A prismatic joint at `placement` on the link of the joint before, which slides by its coordinate.
    pub const fn prismatic(placement: Placement) -> Self {
        Self { kind: JointKind::Prismatic, ..Self::revolute(placement) }
    }

    /// Where the joint sits, the constant angle of a prismatic joint included.
    pub(crate) fn frame(&self) -> JointFrame {
        let frame = self.placement.frame();
        if self.kind.is_revolute() || self.theta_offset_rad == 0.0 {
            return frame;
        }
        let (sin, cos) = exact_sin_cos(self.theta_offset_rad);
        JointFrame {
            rotation: frame.rotation.map(|[x, y, z]| [x * cos + y * sin, y * cos - x * sin, z]),
            ..frame
        }
    }
}

impl Placement {
    /// A translation and then a turn by roll, pitch and yaw about fixed axes, Rot_z(yaw) Rot_y(pitch) Rot_x(roll): the
    /// `origin` of robot description files. Multiples of π/2 give entries that are exactly 0 and ±1.
    pub fn from_roll_pitch_yaw(translation_m: [f64; 3], roll_pitch_yaw_rad: [f64; 3]) -> Self {
        let [(sr, cr), (sp, cp), (sy, cy)] = roll_pitch_yaw_rad.map(exact_sin_cos);
        let rotation = [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ];
        Self::Fixed { rotation, translation_m }
    }

    fn frame(&self) -> JointFrame {
        match *self {
            Self::Mdh { alpha_rad, a_m, d_m } => {
                let (sin, cos) = exact_sin_cos(alpha_rad);
                JointFrame {
                    rotation: [[1.0, 0.0, 0.0], [0.0, cos, -sin], [0.0, sin, cos]],
                    translation_m: [a_m, -d_m * sin, d_m * cos],
                }
            }
            Self::Fixed { rotation, translation_m } => JointFrame { rotation, translation_m },
        }
    }

    pub(crate) fn complaint(&self) -> Option<(&'static str, String)> {
        match *self {
            Self::Mdh { alpha_rad, a_m, d_m } => [
                ("alpha", angle_complaint(alpha_rad)),
                ("a", length_complaint(a_m)),
                ("d", length_complaint(d_m)),
            ]
            .into_iter()
            .find_map(|(name, complaint)| complaint.map(|reason| (name, reason))),
            Self::Fixed { rotation: r, translation_m } => {
                if let Some(reason) = translation_m.iter().find_map(|v| length_complaint(*v)) {
                    return Some(("translation", reason));
                }
                let product = |i: usize, k: usize| -> f64 { (0..3).map(|c| r[i][c] * r[k][c]).sum() };
                let orthonormal = (0..3)
                    .all(|i| (0..3).all(|k| (product(i, k) - if i == k { 1.0 } else { 0.0 }).abs() < 1e-9));
                let determinant = r[0][0] * (r[1][1] * r[2][2] - r[1][2] * r[2][1])
                    - r[0][1] * (r[1][0] * r[2][2] - r[1][2] * r[2][0])
                    + r[0][2] * (r[1][0] * r[2][1] - r[1][1] * r[2][0]);
                // Written so that a NaN in the matrix is a complaint too.
                let rotates = orthonormal && determinant > 0.0;
                (!rotates).then(|| ("rotation", format!("must be orthonormal and right-handed, is {r:?}")))
            }
        }
    }
}

/// Sine and cosine, exactly 0 and ±1 at multiples of π/2 as far as f64 can hold these: parallel and
/// perpendicular axes are meant to be exactly that, and the base parameters depend on it.
fn exact_sin_cos(angle_rad: f64) -> (f64, f64) {
    let (sin, cos) = sine_cosine_of(angle_rad);
    let dust = 4.0 * f64::EPSILON * angle_rad.abs().max(1.0);
    if sin.abs() < dust {
        (0.0, cos.signum())
    } else if cos.abs() < dust {
        (sin.signum(), 0.0)
    } else {
        (sin, cos)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;

    #[test]
    fn right_angles_are_exact() {
        assert_eq!(exact_sin_cos(FRAC_PI_2), (1.0, 0.0));
        assert_eq!(exact_sin_cos(-FRAC_PI_2), (-1.0, 0.0));
        assert_eq!(exact_sin_cos(PI), (0.0, -1.0));
        assert_eq!(exact_sin_cos(-3.0 * FRAC_PI_2), (1.0, 0.0));
        assert_ne!(exact_sin_cos(FRAC_PI_2 + 1e-9).1, 0.0);
    }
}
