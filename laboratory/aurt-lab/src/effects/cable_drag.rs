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
    identifier: "cable_drag",
    family: Family::P,
    summary: "a cable that pulls a joint by how two joints stand to each other",
    presence: Presence::Structural,
    rotors: None,
    takes: kind::Takes::Pair,
    suits: kind::any_joint,
    draw,
    read: kind::read::<CableDrag>,
};

/// A dress pack that runs along two links: it pulls a joint by tension · sin(q − q_a) sin(q_other − q_b).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CableDrag {
    /// The joint.
    pub joint: usize,
    /// The other joint.
    pub other: usize,
    /// Size of the pull, Nm.
    pub tension_nm: f64,
    /// Angles at which the cable is slack, rad.
    pub slack_rad: [f64; 2],
}

fn draw(context: &Draw<'_>, random: &mut Random) -> Box<dyn Effect> {
    let joint = context.joint();
    let drive = &context.robot.drives[joint];
    let other = context.joints.get(1).copied().unwrap_or(0);
    Box::new(CableDrag {
        joint,
        other,
        tension_nm: 4.0 * drive.torque_noise_nm * random.sign(),
        slack_rad: [
            drive.home_rad + random.between(-0.4, 0.4),
            context.robot.drives[other].home_rad + random.between(-0.4, 0.4),
        ],
    })
}

impl Effect for CableDrag {
    fn identifier(&self) -> &'static str {
        KIND.identifier
    }

    fn joints(&self) -> Vec<usize> {
        vec![self.joint]
    }

    fn parameters(&self) -> Vec<(&'static str, Vec<f64>)> {
        vec![("tension_nm", vec![self.tension_nm])]
    }

    fn scale(&mut self, factor: Factor<'_>, robot: &Robot) {
        let most = robot.drives[self.joint].torque_limit_nm;
        self.tension_nm = (self.tension_nm * factor.on(self.joint)).clamp(-most, most);
    }

    fn validate(&self, robot: &Robot) -> Result<(), SimulationError> {
        let mut complaints = Complaints::default();
        check_joints(&mut complaints, KIND.identifier, &[self.joint, self.other], robot);
        complaints.within("pull of the cable in Nm", self.tension_nm, -1e4, 1e4);
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

impl ShaftTorque for CableDrag {
    fn add(&self, at: &Instant<'_>, opposing_nm: &mut [f64]) {
        let [own, others] = self.slack_rad;
        let lay = libm::sin(at.q_rad[self.joint] - own) * libm::sin(at.q_rad[self.other] - others);
        opposing_nm[self.joint] += self.tension_nm * lay;
    }
}
