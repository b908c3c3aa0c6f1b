use aurt_traits::{Branch, Dispatch, Motion, MotionView, Parameter, RegressorTile, RigidBodyRegressor};

use crate::{INERTIAL_PARAMETERS, JointKind, SerialChain, kernel};

/// Names and units of a link's ten standard parameters, in their order.
pub(crate) const NAMES: [(&str, &str); INERTIAL_PARAMETERS] = [
    ("XX", "kg m^2"),
    ("XY", "kg m^2"),
    ("XZ", "kg m^2"),
    ("YY", "kg m^2"),
    ("YZ", "kg m^2"),
    ("ZZ", "kg m^2"),
    ("mX", "kg m"),
    ("mY", "kg m"),
    ("mZ", "kg m"),
    ("m", "kg"),
];

#[typetag::serde(name = "serial_chain")]
impl RigidBodyRegressor for SerialChain {
    fn joints(&self) -> usize {
        Self::joints(self).len()
    }

    fn joint_names(&self) -> &[String] {
        Self::joint_names(self)
    }

    fn slides(&self, joint: usize) -> bool {
        Self::joints(self).get(joint).is_some_and(|joint| joint.kind == JointKind::Prismatic)
    }

    fn link_names(&self) -> &[String] {
        Self::link_names(self)
    }

    fn branches(&self) -> &[Branch] {
        Self::branches(self)
    }

    fn standard_parameters(&self) -> Vec<Parameter> {
        (0..Self::joints(self).len())
            .flat_map(|link| NAMES.map(|(name, unit)| Parameter::new(format!("{name}_{link}"), unit)))
            .collect()
    }

    /// A link loads the joints of its path: a joint is loaded by its subtree. Its own revolute joint feels neither the
    /// mass nor the first moment along the axis, and a joint on the base, whose axis is fixed in space, feels of its own
    /// link's inertia only ZZ. A prismatic joint feels no inertias, and one on the base of its own link only the mass.
    fn loads(&self, parameter: usize, joint: usize) -> bool {
        let (link, entry) = (parameter / INERTIAL_PARAMETERS, parameter % INERTIAL_PARAMETERS);
        let joints = Self::joints(self);
        if link >= joints.len() {
            return false;
        }
        let path = self.path(link);
        path.contains(&joint)
            && kernel::possible_entries(joints[joint].kind, joint == link, path.len() == 1) & (1 << entry)
                != 0
    }

    fn evaluate(&self, motion: MotionView<'_>, out: &mut RegressorTile<'_>) {
        self.evaluate_on(Dispatch::active(), motion, out);
    }

    fn torque(&self, motion: MotionView<'_>, standard: &[f64], out: &mut [f64], stride: usize) {
        self.torque_on(Dispatch::active(), motion, standard, out, stride);
    }

    fn gravity_m_s2(&self) -> [f64; 3] {
        Self::gravity_m_s2(self)
    }

    fn with_gravity(&self, gravity_m_s2: [f64; 3]) -> Box<dyn RigidBodyRegressor> {
        Box::new(self.under_gravity(gravity_m_s2))
    }
}

impl SerialChain {
    /// [`RigidBodyRegressor::evaluate`] on a given instruction set; on [`Dispatch::Baseline`] if this
    /// processor does not have it.
    ///
    /// # Panics
    /// If motion or tile are not those of a robot of this many joints, or the tile has another number of
    /// samples than the motion.
    pub fn evaluate_on(&self, level: Dispatch, motion: MotionView<'_>, out: &mut RegressorTile<'_>) {
        let joints = self.joints().len();
        assert_eq!(motion.joints(), joints, "joints of the motion");
        assert_eq!(out.parameters(), joints * INERTIAL_PARAMETERS, "parameters of the tile");
        assert_eq!(out.samples(), motion.samples(), "samples of the tile");
        kernel::evaluate(level, self, motion, out);
    }

    /// [`RigidBodyRegressor::torque`] on a given instruction set; on [`Dispatch::Baseline`] if this processor does not
    /// have it.
    ///
    /// # Panics
    /// If the motion is not that of a robot of this many joints, there are not ten parameters for each link, or `out`
    /// or `stride` is too short.
    pub fn torque_on(
        &self,
        level: Dispatch,
        motion: MotionView<'_>,
        standard: &[f64],
        out: &mut [f64],
        stride: usize,
    ) {
        let (joints, samples) = (self.joints().len(), motion.samples());
        assert_eq!(motion.joints(), joints, "joints of the motion");
        assert_eq!(standard.len(), joints * INERTIAL_PARAMETERS, "standard parameters");
        assert!(stride >= samples, "stride shorter than a column");
        assert!(joints == 0 || out.len() >= (joints - 1) * stride + samples, "room for the torques");
        kernel::torque(level, self, motion, standard, (out, stride));
    }

    /// The whole regressor Y of one sample, N rows of 10 N, row after row; a convenience for small work.
    ///
    /// # Panics
    /// If a slice does not have N entries.
    pub fn regressor(&self, q_rad: &[f64], qd_rad_s: &[f64], qdd_rad_s2: &[f64]) -> Vec<f64> {
        let joints = self.joints().len();
        let parameters = joints * INERTIAL_PARAMETERS;
        let Ok(motion) = Motion::new(joints, vec![0.0], q_rad.into(), qd_rad_s.into(), qdd_rad_s2.into())
        else {
            panic!("a regressor of {joints} joints needs {joints} positions, velocities and accelerations");
        };
        let mut dense = vec![0.0; joints * parameters];
        let destination: Vec<u32> = (0..joints * parameters).map(|d| d as u32).collect();
        self.evaluate(motion.view(), &mut RegressorTile::new(&destination, parameters, 1, 1, &mut dense));
        dense
    }
}
