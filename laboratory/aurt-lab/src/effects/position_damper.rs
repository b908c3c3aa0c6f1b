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
    identifier: "position_damper",
    family: Family::V,
    summary: "a damper whose orifice opens with the angle",
    presence: Presence::Structural,
    rotors: None,
    takes: kind::Takes::One,
    suits: kind::any_joint,
    draw,
    read: kind::read::<PositionDamper>,
};

/// A hydraulic damper whose orifice opens with the joint: damping · (1 + sin(q − q_0)) q̇.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PositionDamper {
    /// The joint.
    pub joint: usize,
    /// Mean damping, Nm s/rad.
    pub damping_nm_s: f64,
    /// Angle of mean damping, rad.
    pub middle_rad: f64,
}

fn draw(context: &Draw<'_>, random: &mut Random) -> Box<dyn Effect> {
    let joint = context.joint();
    let drive = &context.robot.drives[joint];
    Box::new(PositionDamper {
        joint,
        damping_nm_s: 4.0 * drive.torque_noise_nm,
        middle_rad: drive.home_rad + random.between(-0.5, 0.5),
    })
}

impl Effect for PositionDamper {
    fn identifier(&self) -> &'static str {
        KIND.identifier
    }

    fn joints(&self) -> Vec<usize> {
        vec![self.joint]
    }

    fn parameters(&self) -> Vec<(&'static str, Vec<f64>)> {
        vec![("damping_nm_s", vec![self.damping_nm_s])]
    }

    fn scale(&mut self, factor: Factor<'_>, robot: &Robot) {
        let most = 6.0 * robot.drives[self.joint].viscous_nm_s.max(0.5);
        self.damping_nm_s = (self.damping_nm_s * factor.on(self.joint)).clamp(-most, most);
    }

    fn validate(&self, robot: &Robot) -> Result<(), SimulationError> {
        let mut complaints = Complaints::default();
        check_joints(&mut complaints, KIND.identifier, &[self.joint], robot);
        complaints.within("damping in Nm s/rad", self.damping_nm_s, -1e-12, 1e4);
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

impl ShaftTorque for PositionDamper {
    fn add(&self, at: &Instant<'_>, opposing_nm: &mut [f64]) {
        let opening = 1.0 + libm::sin(at.shaft_rad[self.joint] - self.middle_rad);
        opposing_nm[self.joint] += self.damping_nm_s * opening * at.shaft_rad_s[self.joint];
    }

    fn rate_per_s(&self, inertia_kg_m2: &dyn Fn(usize) -> f64) -> f64 {
        2.0 * self.damping_nm_s / inertia_kg_m2(self.joint)
    }
}
