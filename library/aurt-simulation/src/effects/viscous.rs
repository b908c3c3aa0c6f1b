use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::effect::{Effect, Factor, Hidden, Setup, check_joints, check_values};
use super::kind::{self, Draw, EffectKind, Family, Presence};
use crate::error::Complaints;
use crate::error::SimulationError;
use crate::plant::LinearViscous;
use crate::random::Random;
use crate::robots::Robot;

pub(super) const KIND: EffectKind = EffectKind {
    identifier: "viscous",
    family: Family::V,
    summary: "viscous friction that the experiment leaves out",
    presence: Presence::Structural,
    rotors: None,
    takes: kind::Takes::Few,
    suits: kind::any_joint,
    draw,
    read: kind::read::<Viscous>,
};

/// Viscous friction of its own slope; the experiment has none on these joints.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Viscous {
    /// The joints.
    pub joints: Vec<usize>,
    /// Slope in the place of the robot's own, Nm s/rad.
    pub viscous_nm_s: Vec<f64>,
}

fn draw(context: &Draw<'_>, _random: &mut Random) -> Box<dyn Effect> {
    Box::new(Viscous { joints: context.joints.to_vec(), viscous_nm_s: context.noises(2.0) })
}

impl Effect for Viscous {
    fn identifier(&self) -> &'static str {
        KIND.identifier
    }

    fn joints(&self) -> Vec<usize> {
        self.joints.clone()
    }

    fn parameters(&self) -> Vec<(&'static str, Vec<f64>)> {
        vec![("viscous_nm_s", self.viscous_nm_s.clone())]
    }

    fn hidden(&self) -> Hidden {
        Hidden::Viscous
    }

    fn scale(&mut self, factor: Factor<'_>, robot: &Robot) {
        for (joint, slope) in self.joints.iter().zip(&mut self.viscous_nm_s) {
            *slope =
                (*slope * factor.on(*joint)).clamp(1e-3, 3.0 * robot.drives[*joint].viscous_nm_s.max(0.1));
        }
    }

    fn validate(&self, robot: &Robot) -> Result<(), SimulationError> {
        let mut complaints = Complaints::default();
        check_joints(&mut complaints, KIND.identifier, &self.joints, robot);
        let bounds = (0.0, 1e4);
        check_values(
            &mut complaints,
            KIND.identifier,
            "viscous_nm_s",
            &self.joints,
            &self.viscous_nm_s,
            bounds,
        );
        complaints.finish()
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        for (joint, slope) in self.joints.iter().zip(&self.viscous_nm_s) {
            setup.machine.joints[*joint].viscous = Box::new(LinearViscous(*slope));
            setup.machine.nominal.drives[*joint].viscous_nm_s = *slope;
        }
        Ok(())
    }

    fn fields(&self) -> Value {
        super::effect::fields(self)
    }
}
