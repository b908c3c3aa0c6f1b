use crate::random::Random;

/// What drawing needs to know of a joint, over all recordings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct JointFigures {
    /// Root mean square of q̇, rad/s.
    pub velocity_rad_s: f64,
    /// Smallest and largest q, rad.
    pub range_rad: [f64; 2],
    /// Largest measurement.
    pub peak: f64,
    /// Root mean square of the rigid bodies' torque.
    pub load: f64,
    /// Mean of the joint's own inertia, as fitted, kg m².
    pub inertia: f64,
}

impl JointFigures {
    pub fn width_rad(&self) -> f64 {
        self.range_rad[1] - self.range_rad[0]
    }

    pub fn inside_rad(&self, random: &mut Random) -> f64 {
        self.range_rad[0] + self.width_rad() * random.unit()
    }
}
