use aurt_simulation::effects::declaring::*;
use aurt_simulation::plant::{Instant, ShaftTorque};

/// Drag on a joint that grows with the square of another joint's velocity: drag · q̇_other |q̇_other|.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CrossDrag {
    pub joint: usize,
    pub other: usize,
    pub drag_nm_s2: f64,
}

impl Physics for CrossDrag {
    const KIND: Declaration = Declaration::new("cross_drag", Family::C, Presence::Structural, Takes::Pair);
    const PARAMETERS: &'static [&'static str] = &["drag_nm_s2"];

    fn draw(context: &Draw<'_>, random: &mut Random) -> Self {
        let (joint, drive) = context.drive();
        let other = context.joints.get(1).copied().unwrap_or(0);
        let fast = 0.4 * context.robot.drives[other].velocity_limit_rad_s;
        Self { joint, other, drag_nm_s2: random.sign() * 2.0 * drive.torque_noise_nm / (fast * fast) }
    }

    fn scale(&mut self, factor: Factor<'_>, robot: &Robot) {
        let most = 0.2 * robot.drives[self.joint].torque_limit_nm;
        self.drag_nm_s2 = (self.drag_nm_s2 * factor.on(self.joint)).clamp(-most, most);
    }

    fn check(&self, complaints: &mut Checks<'_>) {
        complaints.joints(&[self.joint, self.other]);
        complaints.within("drag in Nm s^2/rad^2", self.drag_nm_s2, -1e4, 1e4);
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        setup.machine.shaft_torques.push(Box::new(*self));
        Ok(())
    }
}

impl ShaftTorque for CrossDrag {
    fn add(&self, at: &Instant<'_>, opposing_nm: &mut [f64]) {
        let velocity = at.shaft_rad_s[self.other];
        opposing_nm[self.joint] += self.drag_nm_s2 * velocity * velocity.abs();
    }
}
