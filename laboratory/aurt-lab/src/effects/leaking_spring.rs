use serde::{Deserialize, Serialize};
use serde_json::Value;

use aurt_simulation::{
    Random, SimulationError,
    effects::{Draw, Effect, EffectKind, Factor, Family, Presence, Setup, check_joints, fields, kind},
    error::Complaints,
    plant::{Instant, ShaftTorque},
    robots::Robot,
};

pub(super) const KIND: EffectKind = EffectKind {
    identifier: "leaking_spring",
    family: Family::P,
    summary: "a gas spring that loses its pressure during the recording",
    presence: Presence::Structural,
    rotors: None,
    takes: kind::Takes::One,
    suits: kind::any_joint,
    draw,
    read: kind::read::<LeakingSpring>,
};

/// A gas spring that leaks: stiffness · exp(−t/leak) · (q − q_0).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LeakingSpring {
    /// The joint.
    pub joint: usize,
    /// Stiffness at the start, Nm/rad.
    pub stiffness_nm_rad: f64,
    /// Angle without torque, rad.
    pub rest_rad: f64,
    /// Time in which the torque falls to 1/e, s.
    pub leak_s: f64,
}

fn draw(context: &Draw<'_>, random: &mut Random) -> Box<dyn Effect> {
    let joint = context.joint();
    let drive = &context.robot.drives[joint];
    Box::new(LeakingSpring {
        joint,
        stiffness_nm_rad: 6.0 * drive.torque_noise_nm,
        rest_rad: drive.home_rad + random.sign() * random.between(0.5, 1.2),
        leak_s: context.duration_s * random.between(0.25, 0.6),
    })
}

impl Effect for LeakingSpring {
    fn identifier(&self) -> &'static str {
        KIND.identifier
    }

    fn joints(&self) -> Vec<usize> {
        vec![self.joint]
    }

    fn parameters(&self) -> Vec<(&'static str, Vec<f64>)> {
        vec![("stiffness_nm_rad", vec![self.stiffness_nm_rad]), ("leak_s", vec![self.leak_s])]
    }

    fn scale(&mut self, factor: Factor<'_>, robot: &Robot) {
        let most = 0.5 * robot.drives[self.joint].torque_limit_nm;
        self.stiffness_nm_rad = (self.stiffness_nm_rad * factor.on(self.joint)).clamp(-most, most);
    }

    fn validate(&self, robot: &Robot) -> Result<(), SimulationError> {
        let mut complaints = Complaints::default();
        check_joints(&mut complaints, KIND.identifier, &[self.joint], robot);
        complaints.within("stiffness of the spring in Nm/rad", self.stiffness_nm_rad, -1e4, 1e4);
        complaints.positive("time in which the spring leaks in s", self.leak_s);
        complaints.finish()
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        setup.machine.shaft_torques.push(Box::new(*self));
        Ok(())
    }

    fn fields(&self) -> Value {
        fields(self)
    }
}

impl ShaftTorque for LeakingSpring {
    fn add(&self, at: &Instant<'_>, opposing_nm: &mut [f64]) {
        let pressure = libm::exp(-at.time_s / self.leak_s);
        opposing_nm[self.joint] += self.stiffness_nm_rad * pressure * (at.q_rad[self.joint] - self.rest_rad);
    }
}
