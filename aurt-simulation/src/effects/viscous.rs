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
    const PARAMETERS: &'static [&'static str] = &["viscous_nm_s"];
    const HIDDEN: Hidden = Hidden::Viscous;
    const VALUES: &'static [(&'static str, [f64; 2])] = &[("viscous_nm_s", [0.0, 1e4])];

    fn draw(context: &Draw<'_>, _random: &mut Random) -> Self {
        Self { joints: context.joints.to_vec(), viscous_nm_s: context.noises(2.0) }
    }

    fn scale(&mut self, factor: Factor<'_>, robot: &Robot) {
        factor.scale(&self.joints, &mut self.viscous_nm_s, |joint| {
            [1e-3, 3.0 * robot.drives[joint].viscous_nm_s.max(0.1)]
        });
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        for (joint, slope) in self.joints.iter().zip(&self.viscous_nm_s) {
            setup.machine.joints[*joint].viscous = Box::new(LinearViscous(*slope));
            setup.machine.nominal.drives[*joint].viscous_nm_s = *slope;
        }
        Ok(())
    }
}
