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
    const PARAMETERS: &'static [&'static str] = &["offset_rad"];
    const VALUES: &'static [(&'static str, [f64; 2])] = &[("offset_rad", [-7.0, 7.0])];

    /// The first joint often turns about the vertical, the last carries little: their torques hardly know their zeros.
    const SUITS: fn(&Robot, usize) -> bool = |robot, joint| (1..robot.joints() - 1).contains(&joint);

    fn draw(context: &Draw<'_>, random: &mut Random) -> Self {
        Self { joints: context.joints.to_vec(), offset_rad: vec![0.02 * random.sign(); context.joints.len()] }
    }

    fn scale(&mut self, factor: Factor<'_>, _robot: &Robot) {
        factor.scale(&self.joints, &mut self.offset_rad, |_| [-LARGEST_RAD, LARGEST_RAD]);
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        for (joint, offset) in self.joints.iter().zip(&self.offset_rad) {
            setup.instrument.channels[*joint].encoder_offset_rad += offset;
        }
        Ok(())
    }
}
