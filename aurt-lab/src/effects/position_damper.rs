use aurt_simulation::effects::declaring::*;
use aurt_simulation::plant::{Instant, ShaftTorque};

/// A hydraulic damper whose orifice opens with the joint: damping · (1 + sin(q − q_0)) q̇.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PositionDamper {
    pub joint: usize,
    pub damping_nm_s: f64,
    pub middle_rad: f64,
}

impl Physics for PositionDamper {
    const KIND: Declaration =
        Declaration::new("position_damper", Family::V, Presence::Structural, Takes::One);
    const PARAMETERS: &'static [&'static str] = &["damping_nm_s"];

    fn draw(context: &Draw<'_>, random: &mut Random) -> Self {
        let (joint, drive) = context.drive();
        Self {
            joint,
            damping_nm_s: 4.0 * drive.torque_noise_nm,
            middle_rad: drive.home_rad + random.between(-0.5, 0.5),
        }
    }

    fn scale(&mut self, factor: Factor<'_>, robot: &Robot) {
        let most = 6.0 * robot.drives[self.joint].viscous_nm_s.max(0.5);
        self.damping_nm_s = (self.damping_nm_s * factor.on(self.joint)).clamp(-most, most);
    }

    fn check(&self, complaints: &mut Checks<'_>) {
        complaints.within("damping in Nm s/rad", self.damping_nm_s, -1e-12, 1e4);
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        setup.machine.shaft_torques.push(Box::new(*self));
        Ok(())
    }
}

impl ShaftTorque for PositionDamper {
    fn add(&self, at: &Instant<'_>, opposing_nm: &mut [f64]) {
        let opening = 1.0 + libm::sin(at.shaft_rad[self.joint] - self.middle_rad);
        opposing_nm[self.joint] += self.damping_nm_s * opening * at.shaft_rad_s[self.joint];
    }

    fn rate_per_s(&self, inertia_kg_m2: &dyn Fn(usize) -> f64) -> f64 {
        2.0 * self.damping_nm_s / inertia_kg_m2(self.joint)
    }
}
