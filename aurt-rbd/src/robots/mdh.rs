//! Described chains as tables of modified Denavit–Hartenberg parameters.

use crate::{MdhRow, RbdError, RobotDescription};
use nalgebra::{Matrix3, Vector3};

use crate::robots::DescribedRobot;

/// Sine of the angle below which two axes count as parallel.
const PARALLEL: f64 = 1e-10;
/// Distance below which two axes count as one, m.
const ONE_LINE_M: f64 = 1e-12;

/// A chain by its axes alone.
#[derive(Debug, Clone, PartialEq)]
pub struct AsMdh {
    /// A row for each joint, in the reading [`MdhRows::Next`](crate::MdhRows::Next); coordinates are those of the description.
    pub rows: Vec<MdhRow>,
    /// Gravity in the table's base frame, whose z axis is the first joint's, m/s².
    pub gravity_m_s2: [f64; 3],
}

/// An axis: a point of it, its direction, and a direction normal to it.
struct Frame {
    origin_m: Vector3<f64>,
    x: Vector3<f64>,
    z: Vector3<f64>,
}

impl DescribedRobot {
    /// The same chain as a table of modified Denavit–Hartenberg parameters: its joints have the same axes and coordinates, its
    /// links other frames. `gravity_m_s2` is given in the frame of the description's base.
    ///
    /// Between the axes of joints j and j+1, z_j and z_{j+1}, the common normal x has θ_j as its angle about z_j and meets z_j at
    /// d_j; a_j is its length and α_j the angle from z_j to z_{j+1} about it. Source: Craig, *Introduction to Robotics*, section 3.4.
    ///
    /// # Errors
    /// [`RbdError::Coupled`] or [`RbdError::Tree`] if the joints are no chain that moves on its own.
    pub fn as_mdh(&self, gravity_m_s2: [f64; 3]) -> Result<AsMdh, RbdError> {
        let mut links = Vec::new();
        let chain = self.chain(gravity_m_s2)?;
        chain.check_serial()?;
        chain.link_frames(&vec![0.0; self.joints.len()], &mut links);
        let axis = |j: usize| {
            let r = &links[j].rotation;
            let column = |k: usize| Vector3::new(r[0][k], r[1][k], r[2][k]);
            Frame { origin_m: links[j].origin_m.into(), x: column(0), z: column(2) }
        };
        let mut rows = Vec::new();
        let mut here = axis(0);
        let base = Matrix3::from_columns(&[here.x, here.z.cross(&here.x), here.z]);
        for (j, joint) in self.joints.iter().enumerate() {
            let mut row = MdhRow {
                kind: joint.kind,
                alpha_rad: 0.0,
                a_m: 0.0,
                d_m: 0.0,
                theta_offset_rad: 0.0,
                sign: joint.sign,
            };
            if j + 1 < links.len() {
                let next = axis(j + 1);
                let (x, at) = common_normal(&here, &next);
                let y = here.z.cross(&here.x);
                row.theta_offset_rad = x.dot(&y).atan2(x.dot(&here.x));
                row.d_m = at;
                let foot = here.origin_m + here.z * at;
                row.a_m = (next.origin_m - foot).dot(&x);
                row.alpha_rad = here.z.cross(&next.z).dot(&x).atan2(here.z.dot(&next.z));
                here = Frame { origin_m: foot + x * row.a_m, x, z: next.z };
            }
            rows.push(row);
        }
        let gravity = base.transpose() * Vector3::from(gravity_m_s2);
        Ok(AsMdh { rows, gravity_m_s2: gravity.into() })
    }
}

/// The direction of the common normal from one axis to the next, and where on the first it begins.
fn common_normal(here: &Frame, next: &Frame) -> (Vector3<f64>, f64) {
    let between = next.origin_m - here.origin_m;
    let normal = here.z.cross(&next.z);
    let along = between.dot(&here.z);
    if normal.norm() > PARALLEL {
        let x = normal.normalize();
        // The point of `here` that is nearest to `next`: between − z t is normal to z' × x.
        let across = next.z.cross(&x);
        let t = between.dot(&across) / here.z.dot(&across);
        // Of the two directions the one that makes a positive, so that tables look as usual.
        let x = if between.dot(&x) < 0.0 { -x } else { x };
        return (x, t);
    }
    let apart = between - here.z * along;
    let x = if apart.norm() > ONE_LINE_M { apart.normalize() } else { here.x };
    (x, along)
}
