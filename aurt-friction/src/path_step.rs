//! One step along a sampled path, for models with memory.

/// The displacement between two samples and how fast it was travelled.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PathStep {
    /// q_k − q_(k−1) in rad.
    pub(crate) displacement_rad: f64,
    /// The mean velocity over the step, displacement over duration, in rad/s.
    pub(crate) velocity_rad_s: f64,
    /// t_k − t_(k−1) in s, never negative.
    pub(crate) duration_s: f64,
}

impl PathStep {
    /// The step from the previous sample's time and position, which it then replaces by this sample's.
    ///
    /// Where time does not advance (the first sample, a repeated stamp) no mean velocity exists and the measured
    /// one takes its place.
    #[inline]
    pub(crate) fn advance(
        time_s: &mut f64,
        position_rad: &mut f64,
        (t, q, velocity): (f64, f64, f64),
    ) -> Self {
        let displacement_rad = q - *position_rad;
        let duration_s = (t - *time_s).max(0.0);
        let velocity_rad_s = if duration_s > 0.0 { displacement_rad / duration_s } else { velocity };
        (*time_s, *position_rad) = (t, q);
        Self { displacement_rad, velocity_rad_s, duration_s }
    }
}
