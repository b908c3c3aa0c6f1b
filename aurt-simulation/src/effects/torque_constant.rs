use super::declaring::*;

/// The drive's torque constant is (1 + e) times the stated one: measured torques are too small by 1/(1 + e).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TorqueConstant {
    pub joints: Vec<usize>,
    /// e.
    pub gain_error: Vec<f64>,
}

impl Physics for TorqueConstant {
    const IDENTIFIER: &'static str = "torque_constant";
    const FAMILY: Family = Family::D;
    const SUMMARY: &'static str = "a torque constant that is not what the experiment says";
    const PRESENCE: Presence = Presence::Either;
    const TAKES: Takes = Takes::Few;
    const PARAMETERS: &'static [&'static str] = &["gain_error"];
    const VALUES: &'static [(&'static str, [f64; 2])] = &[("gain_error", [-0.9, 9.0])];

    fn draw(context: &Draw<'_>, random: &mut Random) -> Self {
        let gain_error = context.joints.iter().map(|_| random.sign() * random.between(0.05, 0.12)).collect();
        Self { joints: context.joints.to_vec(), gain_error }
    }

    fn scale(&mut self, factor: Factor<'_>, _robot: &Robot) {
        factor.scale(&self.joints, &mut self.gain_error, |_| [-0.5, 1.0]);
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        for (joint, error) in self.joints.iter().zip(&self.gain_error) {
            setup.instrument.channels[*joint].gain_error = *error;
        }
        Ok(())
    }
}
