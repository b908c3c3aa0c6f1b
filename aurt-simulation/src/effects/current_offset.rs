use super::declaring::*;

/// A constant that the measured torque has too much.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CurrentOffset {
    pub joints: Vec<usize>,
    /// The constant, Nm.
    pub offset_nm: Vec<f64>,
}

impl Physics for CurrentOffset {
    const IDENTIFIER: &'static str = "current_offset";
    const FAMILY: Family = Family::D;
    const SUMMARY: &'static str = "a constant in the measured torque";
    const PRESENCE: Presence = Presence::Either;
    const TAKES: Takes = Takes::Few;
    const VALUES: &'static [(&'static str, [f64; 2])] = &[("offset_nm", [-1e4, 1e4])];

    fn draw(context: &Draw<'_>, random: &mut Random) -> Self {
        Self { joints: context.joints.to_vec(), offset_nm: context.noises(random.sign()) }
    }

    fn parameters(&self) -> Vec<(&'static str, Vec<f64>)> {
        vec![("offset", self.offset_nm.clone())]
    }

    fn scale(&mut self, factor: Factor<'_>, robot: &Robot) {
        factor.scale(&self.joints, &mut self.offset_nm, |joint| {
            let most = 0.3 * robot.drives[joint].torque_limit_nm;
            [-most, most]
        });
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        for (joint, offset) in self.joints.iter().zip(&self.offset_nm) {
            setup.instrument.channels[*joint].offset_nm += offset;
        }
        Ok(())
    }
}
