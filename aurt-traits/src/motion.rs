use std::ops::Range;

use crate::ModelError;

/// A motion of an N-joint robot at n times: positions, velocities and accelerations of all joints.
///
/// Stored joint by joint: the series of one joint is contiguous.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Motion {
    joints: usize,
    time_s: Vec<f64>,
    position_rad: Vec<f64>,
    velocity_rad_s: Vec<f64>,
    acceleration_rad_s2: Vec<f64>,
}

impl Motion {
    /// A motion from its series; the three last have `joints × time_s.len()` entries, joint after joint.
    ///
    /// # Errors
    /// [`ModelError::Count`] where a length does not fit.
    pub fn new(
        joints: usize,
        time_s: Vec<f64>,
        position_rad: Vec<f64>,
        velocity_rad_s: Vec<f64>,
        acceleration_rad_s2: Vec<f64>,
    ) -> Result<Self, ModelError> {
        let expected = joints * time_s.len();
        for (what, series) in [
            ("position values", &position_rad),
            ("velocity values", &velocity_rad_s),
            ("acceleration values", &acceleration_rad_s2),
        ] {
            if series.len() != expected {
                return Err(ModelError::Count { what: what.into(), expected, found: series.len() });
            }
        }
        Ok(Self { joints, time_s, position_rad, velocity_rad_s, acceleration_rad_s2 })
    }

    /// Number of joints.
    pub const fn joints(&self) -> usize {
        self.joints
    }

    /// Number of samples.
    pub const fn samples(&self) -> usize {
        self.time_s.len()
    }

    /// The whole motion as a view.
    pub fn view(&self) -> MotionView<'_> {
        let series = [&*self.position_rad, &self.velocity_rad_s, &self.acceleration_rad_s2];
        MotionView::from_strided(self.joints, self.samples(), &self.time_s, series)
    }
}

/// A run of consecutive samples of a [`Motion`]; cheap to copy.
#[derive(Debug, Clone, Copy)]
pub struct MotionView<'a> {
    joints: usize,
    first: usize,
    samples: usize,
    stride: usize,
    time_s: &'a [f64],
    /// Positions, velocities and accelerations.
    series: [&'a [f64]; 3],
}

impl<'a> MotionView<'a> {
    /// One sample, of as many joints as there are positions.
    ///
    /// # Panics
    /// If velocities or accelerations are not as many as positions.
    pub fn of_sample(
        time_s: &'a f64,
        position_rad: &'a [f64],
        velocity_rad_s: &'a [f64],
        acceleration_rad_s2: &'a [f64],
    ) -> Self {
        let joints = position_rad.len();
        assert_eq!(velocity_rad_s.len(), joints, "velocities");
        assert_eq!(acceleration_rad_s2.len(), joints, "accelerations");
        let series = [position_rad, velocity_rad_s, acceleration_rad_s2];
        Self::from_strided(joints, 1, std::slice::from_ref(time_s), series)
    }

    /// Number of joints.
    pub const fn joints(&self) -> usize {
        self.joints
    }

    /// Number of samples in view.
    pub const fn samples(&self) -> usize {
        self.samples
    }

    /// Times in s.
    pub fn time_s(&self) -> &'a [f64] {
        &self.time_s[self.first..self.first + self.samples]
    }

    /// Angles of one joint in rad.
    pub fn position_rad(&self, joint: usize) -> &'a [f64] {
        self.of(0, joint)
    }

    /// Velocities of one joint in rad/s.
    pub fn velocity_rad_s(&self, joint: usize) -> &'a [f64] {
        self.of(1, joint)
    }

    /// Accelerations of one joint in rad/s².
    pub fn acceleration_rad_s2(&self, joint: usize) -> &'a [f64] {
        self.of(2, joint)
    }

    /// The samples `range` of this view.
    ///
    /// # Panics
    /// If `range` reaches beyond the view.
    pub fn slice(&self, range: Range<usize>) -> Self {
        assert!(range.start <= range.end && range.end <= self.samples, "slice beyond the motion");
        Self { first: self.first + range.start, samples: range.end - range.start, ..*self }
    }

    /// Positions, velocities and accelerations of all joints, joint after joint, and the distance between two joints.
    pub(crate) fn strided(&self) -> (usize, [&'a [f64]; 3]) {
        (self.stride, self.series.map(|series| &series[self.first.min(series.len())..]))
    }

    /// The reverse of [`Self::strided`].
    pub(crate) const fn from_strided(
        joints: usize,
        stride: usize,
        time_s: &'a [f64],
        series: [&'a [f64]; 3],
    ) -> Self {
        Self { joints, first: 0, samples: time_s.len(), stride, time_s, series }
    }

    fn of(&self, series: usize, joint: usize) -> &'a [f64] {
        let start = joint * self.stride + self.first;
        &self.series[series][start..start + self.samples]
    }
}

/// The series of one joint that a [`JointModel`](crate::JointModel) receives; all slices have one length.
#[derive(Debug, Clone, Copy)]
pub struct JointSeries<'a> {
    /// Times in s.
    pub time_s: &'a [f64],
    /// Joint angles q in rad.
    pub position_rad: &'a [f64],
    /// Joint velocities q̇ in rad/s.
    pub velocity_rad_s: &'a [f64],
    /// Joint accelerations q̈ in rad/s².
    pub acceleration_rad_s2: &'a [f64],
    /// Load torque τ_J that the joint transmits (unit of the measurement; see [`LoadTorque`](crate::LoadTorque)).
    pub load_torque: &'a [f64],
}

impl<'a> JointSeries<'a> {
    /// The series of one joint of a motion, with its load torque.
    pub fn of(motion: MotionView<'a>, joint: usize, load_torque: &'a [f64]) -> Self {
        Self {
            time_s: motion.time_s(),
            position_rad: motion.position_rad(joint),
            velocity_rad_s: motion.velocity_rad_s(joint),
            acceleration_rad_s2: motion.acceleration_rad_s2(joint),
            load_torque,
        }
    }

    /// Number of samples.
    pub const fn samples(&self) -> usize {
        self.velocity_rad_s.len()
    }

    /// The samples `range` of these series.
    ///
    /// # Panics
    /// If `range` reaches beyond the series.
    pub fn slice(&self, range: Range<usize>) -> Self {
        Self {
            time_s: &self.time_s[range.clone()],
            position_rad: &self.position_rad[range.clone()],
            velocity_rad_s: &self.velocity_rad_s[range.clone()],
            acceleration_rad_s2: &self.acceleration_rad_s2[range.clone()],
            load_torque: &self.load_torque[range],
        }
    }
}
