use super::declaring::*;

/// Largest offset, rad: a tooth of a small belt pulley.
const LARGEST_RAD: f64 = 0.2;

per_joint! {
    /// Encoders whose zero is wrong: what is logged of a joint is its angle and a constant.
    EncoderOffset {
        /// The constant, rad.
        offset_rad: [-7.0, 7.0],
    }
    "encoder_offset", D, Later, One;
    drawn: |context, random| vec![0.02 * random.sign(); context.joints.len()];
    scaled_within: |_robot, _joint| [-LARGEST_RAD, LARGEST_RAD];
    installed: |setup, joint, offset| {
        setup.instrument.channels[joint].encoder_offset_rad += offset;
    }

    /// The first joint often turns about the vertical, the last carries little: their torques hardly know their zeros.
    const SUITS: fn(&Robot, usize) -> bool = |robot, joint| (1..robot.joints() - 1).contains(&joint);
}
