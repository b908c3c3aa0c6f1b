use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::effect::{Effect, Factor, Setup, check_joints};
use super::joint_elasticity::{check_rotors, gear_damping_nm_s, heavy_link, make_compliant};
use super::kind::{self, Draw, EffectKind, Family, Presence};
use crate::error::Complaints;
use crate::error::SimulationError;
use crate::random::Random;
use crate::robots::{Robot, Rotors};

pub(super) const KIND: EffectKind = EffectKind {
    identifier: "backlash",
    family: Family::P,
    summary: "play in a gear",
    presence: Presence::Either,
    rotors: Some(Rotors::Geared),
    takes: kind::Takes::One,
    suits: heavy_link,
    draw,
    read: kind::read::<Backlash>,
};

/// Play in a gear whose flanks are stiff and damped; the encoder sits on the motor.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Backlash {
    /// The joint.
    pub joint: usize,
    /// Half the play, rad.
    pub gap_rad: f64,
    /// Stiffness of the flanks, Nm/rad.
    pub stiffness_nm_rad: f64,
    /// Damping of the flanks, Nm s/rad.
    pub damping_nm_s: f64,
}

fn draw(context: &Draw<'_>, random: &mut Random) -> Box<dyn Effect> {
    let joint = context.joint();
    let drive = &context.robot.drives[joint];
    let stiffness = drive.gear_stiffness_nm_rad;
    Box::new(Backlash {
        joint,
        gap_rad: random.between(0.0015, 0.003),
        stiffness_nm_rad: stiffness,
        damping_nm_s: gear_damping_nm_s(context.robot, joint, stiffness, random.between(0.1, 0.3)),
    })
}

impl Effect for Backlash {
    fn identifier(&self) -> &'static str {
        KIND.identifier
    }

    fn joints(&self) -> Vec<usize> {
        vec![self.joint]
    }

    fn parameters(&self) -> Vec<(&'static str, Vec<f64>)> {
        vec![("gap_rad", vec![self.gap_rad])]
    }

    fn scale(&mut self, factor: Factor<'_>, _robot: &Robot) {
        self.gap_rad = (self.gap_rad * factor.on(self.joint)).clamp(5e-5, 0.03);
    }

    fn validate(&self, robot: &Robot) -> Result<(), SimulationError> {
        let mut complaints = Complaints::default();
        check_joints(&mut complaints, KIND.identifier, &[self.joint], robot);
        check_rotors(&mut complaints, KIND.identifier, &[self.joint], robot);
        complaints.within("play of the gear in rad", self.gap_rad, 0.0, 0.5);
        complaints.within("stiffness of the flanks in Nm/rad", self.stiffness_nm_rad, 1.0, 1e7);
        complaints.within("damping of the flanks in Nm s/rad", self.damping_nm_s, 0.0, 1e4);
        complaints.finish()
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        let Self { joint, gap_rad, stiffness_nm_rad, damping_nm_s } = *self;
        make_compliant(setup, KIND.identifier, joint, stiffness_nm_rad, damping_nm_s, gap_rad)
    }

    fn fields(&self) -> Value {
        super::effect::fields(self)
    }
}
