use super::declaring::*;
use crate::plant::{Instant, LinkTorque};

/// A spring between a link and the one before it, in parallel to the gear: −stiffness (q − rest) on the joint.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spring {
    pub joint: usize,
    pub stiffness_nm_rad: f64,
    /// Angle without torque, rad.
    pub rest_rad: f64,
}

impl Physics for Spring {
    const KIND: Declaration = Declaration::new("spring", Family::P, Presence::Either, Takes::One);
    const PARAMETERS: &'static [&'static str] = &["stiffness_nm_rad", "rest_rad"];

    fn draw(context: &Draw<'_>, random: &mut Random) -> Self {
        let (joint, drive) = context.drive();
        Self {
            joint,
            stiffness_nm_rad: 4.0 * drive.torque_noise_nm,
            rest_rad: drive.home_rad + random.between(-0.5, 0.5),
        }
    }

    fn scale(&mut self, factor: Factor<'_>, robot: &Robot) {
        let most = 0.3 * robot.drives[self.joint].torque_limit_nm;
        self.stiffness_nm_rad = (self.stiffness_nm_rad * factor.on(self.joint)).min(most);
    }

    fn check(&self, complaints: &mut Checks<'_>) {
        complaints.not_negative("stiffness of the spring in Nm/rad", self.stiffness_nm_rad);
        complaints.within("rest angle of the spring in rad", self.rest_rad, -20.0, 20.0);
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        setup.machine.link_torques.push(Box::new(*self));
        Ok(())
    }
}

impl LinkTorque for Spring {
    fn add(&mut self, at: &Instant<'_>, acting_nm: &mut [f64]) {
        acting_nm[self.joint] -= self.stiffness_nm_rad * (at.q_rad[self.joint] - self.rest_rad);
    }
}
