use super::declaring::*;

per_joint! {
    /// A constant that the measured torque has too much.
    CurrentOffset {
        /// The constant, Nm.
        offset_nm: [-1e4, 1e4],
    }
    "current_offset", D, Either, Few;
    drawn: |context, random| context.noises(random.sign());
    scaled_within: |robot, joint| [-0.3, 0.3].map(|share| share * robot.drives[joint].torque_limit_nm);
    installed: |setup, joint, offset| {
        setup.instrument.channels[joint].offset_nm += offset;
    }

    fn parameters(&self) -> Vec<(&'static str, Vec<f64>)> {
        vec![("offset", self.offset_nm.clone())]
    }
}
