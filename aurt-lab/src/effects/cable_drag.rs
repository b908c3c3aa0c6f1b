use aurt_simulation::effects::declaring::*;
use aurt_simulation::plant::{Instant, ShaftTorque};

/// A dress pack that runs along two links: it pulls a joint by tension · sin(q − q_a) sin(q_other − q_b).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CableDrag {
    pub joint: usize,
    pub other: usize,
    /// Size of the pull, Nm.
    pub tension_nm: f64,
    /// Angles at which the cable is slack, rad.
    pub slack_rad: [f64; 2],
}

impl Physics for CableDrag {
    const KIND: Declaration = Declaration::new("cable_drag", Family::P, Presence::Structural, Takes::Pair);
    const PARAMETERS: &'static [&'static str] = &["tension_nm"];

    fn draw(context: &Draw<'_>, random: &mut Random) -> Self {
        let (joint, drive) = context.drive();
        let other = context.joints.get(1).copied().unwrap_or(0);
        Self {
            joint,
            other,
            tension_nm: 4.0 * drive.torque_noise_nm * random.sign(),
            slack_rad: [
                drive.home_rad + random.between(-0.4, 0.4),
                context.robot.drives[other].home_rad + random.between(-0.4, 0.4),
            ],
        }
    }

    fn scale(&mut self, factor: Factor<'_>, robot: &Robot) {
        let most = robot.drives[self.joint].torque_limit_nm;
        self.tension_nm = (self.tension_nm * factor.on(self.joint)).clamp(-most, most);
    }

    fn check(&self, complaints: &mut Checks<'_>) {
        complaints.joints(&[self.joint, self.other]);
        complaints.within("pull of the cable in Nm", self.tension_nm, -1e4, 1e4);
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        setup.machine.shaft_torques.push(Box::new(*self));
        Ok(())
    }
}

impl ShaftTorque for CableDrag {
    fn add(&self, at: &Instant<'_>, opposing_nm: &mut [f64]) {
        let [own, others] = self.slack_rad;
        let lay = libm::sin(at.q_rad[self.joint] - own) * libm::sin(at.q_rad[self.other] - others);
        opposing_nm[self.joint] += self.tension_nm * lay;
    }
}
