use super::declaring::*;

/// Encoders whose zero is wrong: what is logged of a joint is its angle and a constant.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EncoderOffset {
    pub joints: Vec<usize>,
    /// The constant, rad.
    pub offset_rad: Vec<f64>,
}

/// Largest offset, rad: a tooth of a small belt pulley.
const LARGEST_RAD: f64 = 0.2;

impl Physics for EncoderOffset {
    const IDENTIFIER: &'static str = "encoder_offset";
    const FAMILY: Family = Family::D;
    const SUMMARY: &'static str = "an encoder that has lost its zero";
    const PRESENCE: Presence = Presence::Later;
    const TAKES: Takes = Takes::One;

    /// The first joint often turns about the vertical, the last carries little: their torques hardly know their zeros.
    fn suits(robot: &Robot, joint: usize) -> bool {
        (1..robot.joints() - 1).contains(&joint)
    }

    fn draw(context: &Draw<'_>, random: &mut Random) -> Self {
        Self { joints: context.joints.to_vec(), offset_rad: vec![0.02 * random.sign(); context.joints.len()] }
    }

    fn parameters(&self) -> Vec<(&'static str, Vec<f64>)> {
        vec![("offset_rad", self.offset_rad.clone())]
    }

    fn scale(&mut self, factor: Factor<'_>, _robot: &Robot) {
        for (joint, offset) in self.joints.iter().zip(&mut self.offset_rad) {
            *offset = (*offset * factor.on(*joint)).clamp(-LARGEST_RAD, LARGEST_RAD);
        }
    }

    fn check(&self, complaints: &mut Checks<'_>) {
        complaints.values("offset_rad", &self.offset_rad, (-7.0, 7.0));
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        for (joint, offset) in self.joints.iter().zip(&self.offset_rad) {
            setup.instrument.channels[*joint].encoder_offset_rad += offset;
        }
        Ok(())
    }
}
