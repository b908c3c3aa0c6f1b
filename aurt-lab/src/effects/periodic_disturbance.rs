use aurt_simulation::effects::declaring::*;
use aurt_simulation::plant::{Instant, ShaftTorque};

/// A torque of a fixed frequency in time, as of a fan or a pump on the arm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PeriodicDisturbance {
    pub joint: usize,
    pub amplitude_nm: f64,
    pub frequency_hz: f64,
}

impl Physics for PeriodicDisturbance {
    const KIND: Declaration =
        Declaration::new("periodic_disturbance", Family::X, Presence::Either, Takes::One);
    const PARAMETERS: &'static [&'static str] = &["amplitude_nm", "frequency_hz"];

    fn draw(context: &Draw<'_>, random: &mut Random) -> Self {
        let (joint, drive) = context.drive();
        Self { joint, amplitude_nm: 1.5 * drive.torque_noise_nm, frequency_hz: random.between(1.7, 6.0) }
    }

    fn scale(&mut self, factor: Factor<'_>, robot: &Robot) {
        let most = 0.4 * robot.drives[self.joint].torque_limit_nm;
        self.amplitude_nm = (self.amplitude_nm * factor.on(self.joint)).clamp(-most, most);
    }

    fn check(&self, complaints: &mut Checks<'_>) {
        complaints.within("amplitude of the disturbance in Nm", self.amplitude_nm, -1e4, 1e4);
        complaints.within("frequency of the disturbance in Hz", self.frequency_hz, 0.0, 200.0);
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        setup.machine.shaft_torques.push(Box::new(*self));
        Ok(())
    }
}

impl ShaftTorque for PeriodicDisturbance {
    fn add(&self, at: &Instant<'_>, opposing_nm: &mut [f64]) {
        let angle = std::f64::consts::TAU * self.frequency_hz * at.time_s;
        opposing_nm[self.joint] += self.amplitude_nm * libm::sin(angle);
    }
}
