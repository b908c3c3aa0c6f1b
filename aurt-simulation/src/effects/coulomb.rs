use super::declaring::*;

/// Coulomb friction of its own level; the experiment has none on these joints.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Coulomb {
    pub joints: Vec<usize>,
    /// Level in the place of the robot's own, Nm.
    pub coulomb_nm: Vec<f64>,
}

impl Physics for Coulomb {
    const IDENTIFIER: &'static str = "coulomb";
    const FAMILY: Family = Family::F;
    const SUMMARY: &'static str = "dry friction that the experiment leaves out";
    const PRESENCE: Presence = Presence::Structural;
    const TAKES: Takes = Takes::Few;
    const PARAMETERS: &'static [&'static str] = &["coulomb_nm"];
    const SUITS: fn(&Robot, usize) -> bool = constant_level;
    const HIDDEN: Hidden = Hidden::Coulomb;
    const VALUES: &'static [(&'static str, [f64; 2])] = &[("coulomb_nm", [0.0, 1e4])];

    fn draw(context: &Draw<'_>, _random: &mut Random) -> Self {
        Self { joints: context.joints.to_vec(), coulomb_nm: context.noises(1.2) }
    }

    fn scale(&mut self, factor: Factor<'_>, robot: &Robot) {
        factor.scale(&self.joints, &mut self.coulomb_nm, |joint| {
            [1e-3, 2.0 * robot.drives[joint].coulomb_nm.max(0.1)]
        });
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        for (joint, level) in self.joints.iter().zip(&self.coulomb_nm) {
            setup.machine.joints[*joint].coulomb_nm = [*level; 2];
            setup.machine.nominal.drives[*joint].coulomb_nm = *level;
        }
        Ok(())
    }
}
