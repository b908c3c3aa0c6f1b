use super::declaring::*;
use crate::plant::LinearViscous;

/// Viscous friction of its own slope; the experiment has none on these joints.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Viscous {
    pub joints: Vec<usize>,
    /// Slope in the place of the robot's own, Nm s/rad.
    pub viscous_nm_s: Vec<f64>,
}

impl Physics for Viscous {
    const IDENTIFIER: &'static str = "viscous";
    const FAMILY: Family = Family::V;
    const SUMMARY: &'static str = "viscous friction that the experiment leaves out";
    const PRESENCE: Presence = Presence::Structural;
    const TAKES: Takes = Takes::Few;

    fn draw(context: &Draw<'_>, _random: &mut Random) -> Self {
        Self { joints: context.joints.to_vec(), viscous_nm_s: context.noises(2.0) }
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

    fn check(&self, complaints: &mut Checks<'_>) {
        let bounds = (0.0, 1e4);
        complaints.values("viscous_nm_s", &self.viscous_nm_s, bounds);
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        for (joint, slope) in self.joints.iter().zip(&self.viscous_nm_s) {
            setup.machine.joints[*joint].viscous = Box::new(LinearViscous(*slope));
            setup.machine.nominal.drives[*joint].viscous_nm_s = *slope;
        }
        Ok(())
    }
}
