use nalgebra::{Matrix3, Vector3};

use crate::joint::JointFrame;
use crate::{INERTIAL_PARAMETERS, Joint, JointKind, RbdError, SerialChain};

/// A chain or tree with its inertial parameters: inverse and forward dynamics, mass matrix and energy, one sample
/// at a time and without allocation.
///
/// The methods take `&mut self` for their working memory alone; none depends on an earlier call. A rotor
/// inertia I_a of a joint ([`Self::with_rotor_inertia`]) adds I_a q̈ to its torque; it is part of all results.
#[derive(Debug, Clone)]
pub struct ChainDynamics {
    pub(crate) chain: SerialChain,
    pub(crate) links: Vec<LinkInertia>,
    pub(crate) rotor_inertia_kg_m2: Vec<f64>,
    pub(crate) scratch: Vec<LinkScratch>,
}

/// A link's inertia about its frame's origin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LinkInertia {
    pub inertia: Matrix3<f64>,
    pub first_moment: Vector3<f64>,
    pub mass: f64,
}

/// What of a moment and a force at a link frame's origin its joint carries.
pub(crate) fn on_axis(kind: JointKind, moment: &Vector3<f64>, force: &Vector3<f64>) -> f64 {
    match kind {
        JointKind::Revolute => moment.z,
        JointKind::Prismatic => force.z,
    }
}

/// A joint's rate about or along its axis z: the angular and the linear velocity that it adds to its link.
pub(crate) fn joint_velocity(kind: JointKind, rate: f64) -> (Vector3<f64>, Vector3<f64>) {
    match kind {
        JointKind::Revolute => (Vector3::z() * rate, Vector3::zeros()),
        JointKind::Prismatic => (Vector3::zeros(), Vector3::z() * rate),
    }
}

/// What the recursions remember of a link, in the link's frame.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct LinkScratch {
    /// Maps coordinates in this link frame to the parent's.
    pub rotation: Matrix3<f64>,
    /// Origin of this link frame in the parent's.
    pub origin: Vector3<f64>,
    /// What links further out need of this one: velocities and accelerations, of which each algorithm has its own.
    pub motion: [Vector3<f64>; 3],
    /// Maps coordinates in this link frame to the base frame, where an algorithm needs it.
    pub in_base: Matrix3<f64>,
    pub moment: Vector3<f64>,
    pub force: Vector3<f64>,
    pub bias_angular: Vector3<f64>,
    pub bias_linear: Vector3<f64>,
    pub articulated: Articulated,
    /// Articulated (or composite) inertia times the joint's axis: moment and force.
    pub axis_moment: Vector3<f64>,
    pub axis_force: Vector3<f64>,
    pub axis_inertia: f64,
    pub axis_torque: f64,
}

/// A symmetric 6 × 6 inertia in blocks: moment = J ω̇ + H a, force = Hᵀ ω̇ + M a.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Articulated {
    pub j: Matrix3<f64>,
    pub h: Matrix3<f64>,
    pub m: Matrix3<f64>,
}

impl ChainDynamics {
    /// The dynamics of `chain` with 10 N standard parameters, link after link {XX XY XZ YY YZ ZZ mX mY mZ m}.
    ///
    /// # Errors
    /// [`RbdError::Count`] or [`RbdError::NotFinite`]. Whether the parameters are those of a real body is
    /// for [`inconsistencies`](crate::inconsistencies) to say.
    pub fn new(chain: SerialChain, standard: &[f64]) -> Result<Self, RbdError> {
        let joints = chain.joints().len();
        let expected = joints * INERTIAL_PARAMETERS;
        if standard.len() != expected {
            let found = standard.len();
            return Err(RbdError::Count { what: "standard inertial parameters", expected, found });
        }
        check_finite("standard inertial parameter", standard)?;
        let links = standard.chunks_exact(INERTIAL_PARAMETERS).map(LinkInertia::from_standard).collect();
        let scratch = vec![LinkScratch::default(); joints];
        Ok(Self { chain, links, rotor_inertia_kg_m2: vec![0.0; joints], scratch })
    }

    /// The same robot with rotor inertias, reflected to the joint's side, in kg m².
    ///
    /// # Errors
    /// [`RbdError::Count`] or [`RbdError::NotFinite`].
    pub fn with_rotor_inertia(mut self, rotor_inertia_kg_m2: &[f64]) -> Result<Self, RbdError> {
        let (expected, found) = (self.joints(), rotor_inertia_kg_m2.len());
        if found != expected {
            return Err(RbdError::Count { what: "rotor inertias", expected, found });
        }
        check_finite("rotor inertia", rotor_inertia_kg_m2)?;
        self.rotor_inertia_kg_m2.copy_from_slice(rotor_inertia_kg_m2);
        Ok(self)
    }

    /// Number of joints N.
    pub fn joints(&self) -> usize {
        self.links.len()
    }

    /// Sets rotation and origin of every link frame for the joint angles `q_rad`.
    pub(crate) fn place(&mut self, q_rad: &[f64]) {
        assert_eq!(q_rad.len(), self.joints(), "joint angles");
        for ((link, frame), (joint, q)) in
            self.scratch.iter_mut().zip(self.chain.frames()).zip(self.chain.joints().iter().zip(q_rad))
        {
            (link.rotation, link.origin) = link_place(frame, joint, *q);
        }
    }
}

fn check_finite(what: &'static str, values: &[f64]) -> Result<(), RbdError> {
    match values.iter().position(|v| !v.is_finite()) {
        Some(index) => Err(RbdError::NotFinite { what, index, value: values[index] }),
        None => Ok(()),
    }
}

/// The rotation that maps coordinates in a link frame, at the joint coordinate q, to the parent's, and the link
/// frame's origin in the parent's.
pub(crate) fn link_place(frame: &JointFrame, joint: &Joint, q: f64) -> (Matrix3<f64>, Vector3<f64>) {
    let r = &frame.rotation;
    let origin = Vector3::from(frame.translation_m);
    match joint.kind {
        JointKind::Revolute => {
            let (sin, cos) = libm::sincos(joint.sign * q + joint.theta_offset_rad);
            let rotation = Matrix3::from_fn(|row, column| match column {
                0 => r[row][0] * cos + r[row][1] * sin,
                1 => r[row][1] * cos - r[row][0] * sin,
                _ => r[row][2],
            });
            (rotation, origin)
        }
        JointKind::Prismatic => {
            let rotation = Matrix3::from(*r).transpose();
            (rotation, origin + rotation.column(2) * (joint.sign * q))
        }
    }
}

impl LinkInertia {
    fn from_standard(p: &[f64]) -> Self {
        Self {
            inertia: Matrix3::new(p[0], p[1], p[2], p[1], p[3], p[4], p[2], p[4], p[5]),
            first_moment: Vector3::new(p[6], p[7], p[8]),
            mass: p[9],
        }
    }

    /// The link as a rigid 6 × 6 inertia.
    pub fn articulated(&self) -> Articulated {
        Articulated {
            j: self.inertia,
            h: self.first_moment.cross_matrix(),
            m: Matrix3::from_diagonal_element(self.mass),
        }
    }
}

impl Articulated {
    /// Moment and force of a unit acceleration of a joint along its axis z.
    pub fn along_axis(&self, kind: JointKind) -> (Vector3<f64>, Vector3<f64>) {
        match kind {
            JointKind::Revolute => (self.j.column(2).into_owned(), self.h.row(2).transpose()),
            JointKind::Prismatic => (self.h.column(2).into_owned(), self.m.column(2).into_owned()),
        }
    }

    /// The same inertia seen from the parent's link frame, whose coordinates `rotation` maps to and in
    /// which the link frame's origin is `origin`.
    pub fn in_previous(&self, rotation: &Matrix3<f64>, origin: &Vector3<f64>) -> Self {
        let j = rotation * self.j * rotation.transpose();
        let h = rotation * self.h * rotation.transpose();
        let m = rotation * self.m * rotation.transpose();
        let r = origin.cross_matrix();
        let shifted = h + r * m;
        Self { j: j - h * r + r * shifted.transpose(), h: shifted, m }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{MdhRows, MdhTable};

    #[test]
    fn parameters_that_do_not_fit_are_refused() {
        let table = MdhTable::parse("alpha,a,d\n0,1,0\n0,0,0\n", "", MdhRows::Next).unwrap();
        let chain = SerialChain::from_mdh(&table, [0.0, 0.0, -9.81]).unwrap();
        let error = ChainDynamics::new(chain.clone(), &[1.0; 10]).unwrap_err().to_string();
        assert_eq!(error, "standard inertial parameters: expected 20, got 10");
        let mut standard = [1.0; 20];
        standard[13] = f64::INFINITY;
        let error = ChainDynamics::new(chain.clone(), &standard).unwrap_err().to_string();
        assert_eq!(error, "standard inertial parameter 13 is not finite: inf");
        let dynamics = ChainDynamics::new(chain.clone(), &[1.0; 20]).unwrap();
        assert!(dynamics.clone().with_rotor_inertia(&[1.0]).is_err());
        assert!(dynamics.with_rotor_inertia(&[1.0, f64::NAN]).is_err());
        assert!(matches!(SerialChain::new(vec![], [0.0; 3]), Err(RbdError::NoJoints)));
        let gravity = [0.0, f64::NAN, 0.0];
        assert!(matches!(SerialChain::from_mdh(&table, gravity), Err(RbdError::Gravity { .. })));
    }
}
