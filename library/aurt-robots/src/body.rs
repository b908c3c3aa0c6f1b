use aurt_rbd::{INERTIAL_PARAMETERS, LinkBody};
use nalgebra::{Matrix3, Vector3};

use crate::pose::Pose;

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
