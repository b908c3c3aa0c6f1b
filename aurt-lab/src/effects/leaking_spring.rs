use aurt_simulation::effects::declaring::*;
use aurt_simulation::plant::{Instant, ShaftTorque};

/// A gas spring that leaks: stiffness · exp(−t/leak) · (q − q_0).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LeakingSpring {
    pub joint: usize,
    pub stiffness_nm_rad: f64,
    /// Angle without torque, rad.
    pub rest_rad: f64,
    /// Time in which the torque falls to 1/e, s.
    pub leak_s: f64,
}

impl Physics for LeakingSpring {
    const KIND: Declaration = Declaration::new("leaking_spring", Family::P, Presence::Structural, Takes::One);
    const PARAMETERS: &'static [&'static str] = &["stiffness_nm_rad", "leak_s"];

    fn draw(context: &Draw<'_>, random: &mut Random) -> Self {
        let (joint, drive) = context.drive();
        Self {
            joint,
            stiffness_nm_rad: 6.0 * drive.torque_noise_nm,
            rest_rad: drive.home_rad + random.sign() * random.between(0.5, 1.2),
            leak_s: context.duration_s * random.between(0.25, 0.6),
        }
    }

    fn scale(&mut self, factor: Factor<'_>, robot: &Robot) {
        let most = 0.5 * robot.drives[self.joint].torque_limit_nm;
        self.stiffness_nm_rad = (self.stiffness_nm_rad * factor.on(self.joint)).clamp(-most, most);
    }

    fn check(&self, complaints: &mut Checks<'_>) {
        complaints.within("stiffness of the spring in Nm/rad", self.stiffness_nm_rad, -1e4, 1e4);
        complaints.positive("time in which the spring leaks in s", self.leak_s);
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        setup.machine.shaft_torques.push(Box::new(*self));
        Ok(())
    }
}

impl ShaftTorque for LeakingSpring {
    fn add(&self, at: &Instant<'_>, opposing_nm: &mut [f64]) {
        let pressure = libm::exp(-at.time_s / self.leak_s);
        opposing_nm[self.joint] += self.stiffness_nm_rad * pressure * (at.q_rad[self.joint] - self.rest_rad);
    }
}
