use super::declaring::*;

/// The measured torque stops at ± the limit; the drive's does not.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Saturation {
    pub joint: usize,
    pub limit_nm: f64,
    /// The largest torque that the motion needs, Nm.
    pub peak_nm: f64,
}

impl Physics for Saturation {
    const KIND: Declaration = Declaration::new("saturation", Family::D, Presence::Either, Takes::One);

    fn draw(context: &Draw<'_>, random: &mut Random) -> Self {
        let joint = context.drive().0;
        let peak_nm = context.peak_torque_nm.get(joint).copied().unwrap_or(1.0).max(1e-3);
        Self { joint, limit_nm: peak_nm * random.between(0.65, 0.8), peak_nm }
    }

    fn parameters(&self) -> Vec<(&'static str, Vec<f64>)> {
        vec![("limit", vec![self.limit_nm])]
    }

    fn scale(&mut self, factor: Factor<'_>, _robot: &Robot) {
        // What is cut off grows faster than the share of the range that is missing.
        let missing = (1.0 - self.limit_nm / self.peak_nm) * factor.on(self.joint).max(0.0).sqrt();
        self.limit_nm = self.peak_nm * (1.0 - missing).clamp(0.25, 0.98);
    }

    fn check(&self, complaints: &mut Checks<'_>) {
        complaints.positive("limit of the measured torque in Nm", self.limit_nm);
        complaints.positive("largest torque of the motion in Nm", self.peak_nm);
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        let channel = &mut setup.instrument.channels[self.joint];
        channel.saturation_nm = channel.saturation_nm.min(self.limit_nm);
        Ok(())
    }
}
