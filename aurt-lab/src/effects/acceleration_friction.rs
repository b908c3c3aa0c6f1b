use aurt_simulation::effects::declaring::*;
use aurt_simulation::plant::{DryTerm, Instant};

/// Dry friction that grows with the size of the acceleration at the last step: level · |q̈| / (1 rad/s²).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AccelerationFriction {
    pub joint: usize,
    pub growth_nm_s2: f64,
}

impl Physics for AccelerationFriction {
    const KIND: Declaration =
        Declaration::new("acceleration_friction", Family::F, Presence::Structural, Takes::One);
    const PARAMETERS: &'static [&'static str] = &["growth_nm_s2"];

    fn draw(context: &Draw<'_>, random: &mut Random) -> Self {
        let (joint, drive) = context.drive();
        let growth = random.between(2.0, 4.0) / drive.acceleration_limit_rad_s2;
        Self { joint, growth_nm_s2: growth * drive.torque_noise_nm }
    }

    fn scale(&mut self, factor: Factor<'_>, robot: &Robot) {
        let most = 10.0 * robot.drives[self.joint].coulomb_nm.max(0.1)
            / robot.drives[self.joint].acceleration_limit_rad_s2;
        self.growth_nm_s2 = (self.growth_nm_s2 * factor.on(self.joint)).clamp(-most, most);
    }

    fn check(&self, complaints: &mut Checks<'_>) {
        complaints.within("growth of friction in Nm s^2/rad", self.growth_nm_s2, -1e-12, 1e4);
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        setup.machine.joints[self.joint].dry_terms.push(Box::new(*self));
        Ok(())
    }
}

impl DryTerm for AccelerationFriction {
    fn level_nm(&self, joint: usize, at: &Instant<'_>, _direction: f64) -> f64 {
        self.growth_nm_s2 * at.last_qdd_rad_s2[joint].abs()
    }
}
