use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::effect::{Effect, Factor, Hidden, Setup, check_joints, check_values};
use super::kind::{self, Draw, EffectKind, Family, Presence};
use crate::error::Complaints;
use crate::error::SimulationError;
use crate::random::Random;
use crate::robots::Robot;

pub(super) const KIND: EffectKind = EffectKind {
    identifier: "coulomb",
    family: Family::F,
    summary: "dry friction that the experiment leaves out",
    presence: Presence::Structural,
    rotors: None,
    takes: kind::Takes::Few,
    suits: constant_level,
    draw,
    read: kind::read::<Coulomb>,
};

/// Coulomb friction of its own level; the experiment has none on these joints.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Coulomb {
    /// The joints.
    pub joints: Vec<usize>,
    /// Level in the place of the robot's own, Nm.
    pub coulomb_nm: Vec<f64>,
}

/// Whether a joint's friction does not depend on the load by itself.
fn constant_level(robot: &Robot, joint: usize) -> bool {
    robot.drives[joint].load_coefficient == 0.0
}

fn draw(context: &Draw<'_>, _random: &mut Random) -> Box<dyn Effect> {
    Box::new(Coulomb { joints: context.joints.to_vec(), coulomb_nm: context.noises(1.2) })
}

impl Effect for Coulomb {
    fn identifier(&self) -> &'static str {
        KIND.identifier
    }

    fn joints(&self) -> Vec<usize> {
        self.joints.clone()
    }

    fn parameters(&self) -> Vec<(&'static str, Vec<f64>)> {
        vec![("coulomb_nm", self.coulomb_nm.clone())]
    }

    fn hidden(&self) -> Hidden {
        Hidden::Coulomb
    }

    fn scale(&mut self, factor: Factor<'_>, robot: &Robot) {
        for (joint, level) in self.joints.iter().zip(&mut self.coulomb_nm) {
            *level = (*level * factor.on(*joint)).clamp(1e-3, 2.0 * robot.drives[*joint].coulomb_nm.max(0.1));
        }
    }

    fn validate(&self, robot: &Robot) -> Result<(), SimulationError> {
        let mut complaints = Complaints::default();
        check_joints(&mut complaints, KIND.identifier, &self.joints, robot);
        check_values(
            &mut complaints,
            KIND.identifier,
            "coulomb_nm",
            &self.joints,
            &self.coulomb_nm,
            (0.0, 1e4),
        );
        complaints.finish()
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        for (joint, level) in self.joints.iter().zip(&self.coulomb_nm) {
            setup.machine.joints[*joint].coulomb_nm = [*level; 2];
            setup.machine.nominal.drives[*joint].coulomb_nm = *level;
        }
        Ok(())
    }

    fn fields(&self) -> Value {
        super::effect::fields(self)
    }
}
