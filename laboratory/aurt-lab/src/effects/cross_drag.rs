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
    identifier: "cross_drag",
    family: Family::C,
    summary: "drag on a joint with the square of another's speed",
    presence: Presence::Structural,
    rotors: None,
    takes: kind::Takes::Pair,
    suits: kind::any_joint,
    draw,
    read: kind::read::<CrossDrag>,
};

/// Drag on a joint that grows with the square of another joint's velocity: drag · q̇_other |q̇_other|.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CrossDrag {
    /// The joint.
    pub joint: usize,
    /// The other joint.
    pub other: usize,
    /// Drag, Nm s²/rad².
    pub drag_nm_s2: f64,
}

fn draw(context: &Draw<'_>, random: &mut Random) -> Box<dyn Effect> {
    let joint = context.joint();
    let drive = &context.robot.drives[joint];
    let other = context.joints.get(1).copied().unwrap_or(0);
    let fast = 0.4 * context.robot.drives[other].velocity_limit_rad_s;
    Box::new(CrossDrag {
        joint,
        other,
        drag_nm_s2: random.sign() * 2.0 * drive.torque_noise_nm / (fast * fast),
    })
}

impl Effect for CrossDrag {
    fn identifier(&self) -> &'static str {
        KIND.identifier
    }

    fn joints(&self) -> Vec<usize> {
        vec![self.joint]
    }

    fn parameters(&self) -> Vec<(&'static str, Vec<f64>)> {
        vec![("drag_nm_s2", vec![self.drag_nm_s2])]
    }

    fn scale(&mut self, factor: Factor<'_>, robot: &Robot) {
        let most = 0.2 * robot.drives[self.joint].torque_limit_nm;
        self.drag_nm_s2 = (self.drag_nm_s2 * factor.on(self.joint)).clamp(-most, most);
    }

    fn validate(&self, robot: &Robot) -> Result<(), SimulationError> {
        let mut complaints = Complaints::default();
        check_joints(&mut complaints, KIND.identifier, &[self.joint, self.other], robot);
        complaints.within("drag in Nm s^2/rad^2", self.drag_nm_s2, -1e4, 1e4);
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

impl ShaftTorque for CrossDrag {
    fn add(&self, at: &Instant<'_>, opposing_nm: &mut [f64]) {
        let velocity = at.shaft_rad_s[self.other];
        opposing_nm[self.joint] += self.drag_nm_s2 * velocity * velocity.abs();
    }
}
