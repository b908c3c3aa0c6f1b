//! Series of this crate as the ABI's, and back.

use std::slice;

use super::Series;
use crate::{ArmSeries, JointSeries, MotionView, RigidBodyRegressor};

impl Series {
    /// The series of one joint.
    pub fn of_joint(series: &JointSeries<'_>) -> Self {
        let samples = series.samples();
        Self {
            size: size_of::<Self>(),
            samples,
            joints: 1,
            stride: samples,
            load_stride: samples,
            time_s: series.time_s.as_ptr(),
            position_rad: series.position_rad.as_ptr(),
            velocity_rad_s: series.velocity_rad_s.as_ptr(),
            acceleration_rad_s2: series.acceleration_rad_s2.as_ptr(),
            load_torque: series.load_torque.as_ptr(),
        }
    }

    /// The series of all joints.
    pub fn of_arm(series: &ArmSeries<'_>) -> Self {
        let motion = &series.motion;
        let (stride, [position, velocity, acceleration]) = motion.strided();
        Self {
            size: size_of::<Self>(),
            samples: motion.samples(),
            joints: motion.joints(),
            stride,
            load_stride: series.load_stride,
            time_s: motion.time_s().as_ptr(),
            position_rad: position.as_ptr(),
            velocity_rad_s: velocity.as_ptr(),
            acceleration_rad_s2: acceleration.as_ptr(),
            load_torque: series.load_torque.as_ptr(),
        }
    }

    /// The series of the first joint.
    ///
    /// # Safety
    /// Every pointer leads to at least `samples` values that nobody changes during `'a`.
    pub(super) unsafe fn as_joint<'a>(&self) -> JointSeries<'a> {
        // SAFETY: the caller promises `samples` values behind every pointer.
        let of = |first: *const f64| unsafe { slice::from_raw_parts(first, self.samples) };
        JointSeries {
            time_s: of(self.time_s),
            position_rad: of(self.position_rad),
            velocity_rad_s: of(self.velocity_rad_s),
            acceleration_rad_s2: of(self.acceleration_rad_s2),
            load_torque: of(self.load_torque),
        }
    }

    /// The series of all joints of these bodies.
    ///
    /// # Safety
    /// Every pointer leads to the values that the struct describes, and nobody changes them during `'a`.
    pub unsafe fn as_arm<'a>(&self, rigid_body: &'a dyn RigidBodyRegressor) -> ArmSeries<'a> {
        let reach =
            |stride: usize| if self.joints == 0 { 0 } else { (self.joints - 1) * stride + self.samples };
        // SAFETY: the caller promises `joints` series, `stride` apart, of `samples` values each.
        let of = |first: *const f64, len: usize| unsafe { slice::from_raw_parts(first, len) };
        let motion = MotionView::from_strided(
            self.joints,
            self.stride,
            of(self.time_s, self.samples),
            [self.position_rad, self.velocity_rad_s, self.acceleration_rad_s2]
                .map(|first| of(first, reach(self.stride))),
        );
        let load_torque = of(self.load_torque, reach(self.load_stride));
        ArmSeries { motion, load_torque, load_stride: self.load_stride, rigid_body }
    }
}
