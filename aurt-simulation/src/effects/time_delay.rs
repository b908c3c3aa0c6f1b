use super::declaring::*;

/// The torque in a row is older than its position.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimeDelay {
    /// By how much, s.
    pub delay_s: f64,
}

impl Physics for TimeDelay {
    const KIND: Declaration = Declaration::new("time_delay", Family::D, Presence::Either, Takes::All);
    const PARAMETERS: &'static [&'static str] = &["delay_s"];

    fn draw(_context: &Draw<'_>, random: &mut Random) -> Self {
        Self { delay_s: random.between(0.004, 0.008) }
    }

    fn scale(&mut self, factor: Factor<'_>, _robot: &Robot) {
        self.delay_s = (self.delay_s * factor.on(0)).clamp(2e-4, 0.08);
    }

    fn check(&self, complaints: &mut Checks<'_>) {
        complaints.within("delay of the torque in s", self.delay_s, -0.5, 0.5);
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        setup.instrument.torque_delay_s += self.delay_s;
        Ok(())
    }
}
