use crate::{INERTIAL_PARAMETERS, LinkBody};
use nalgebra::{Matrix3, Vector3};

use crate::robots::pose::Pose;

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
