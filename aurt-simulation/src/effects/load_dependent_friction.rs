use super::declaring::*;

/// Dry friction in proportion to the transmitted torque, beside the constant level.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoadDependentFriction {
    pub joints: Vec<usize>,
    /// Friction per load, Nm/Nm.
    pub load_coefficient: Vec<f64>,
}

impl Physics for LoadDependentFriction {
    const IDENTIFIER: &'static str = "load_dependent_friction";
    const FAMILY: Family = Family::L;
    const SUMMARY: &'static str = "dry friction that grows with the torque that the gear transmits";
    const PRESENCE: Presence = Presence::Structural;
    const TAKES: Takes = Takes::Few;
    const PARAMETERS: &'static [&'static str] = &["load_coefficient"];
    const SUITS: fn(&Robot, usize) -> bool = constant_level;
    const VALUES: &'static [(&'static str, [f64; 2])] = &[("load_coefficient", [0.0, 0.9])];

    fn draw(context: &Draw<'_>, random: &mut Random) -> Self {
        let coefficient = random.between(0.06, 0.15);
        Self { joints: context.joints.to_vec(), load_coefficient: vec![coefficient; context.joints.len()] }
    }

    fn scale(&mut self, factor: Factor<'_>, _robot: &Robot) {
        factor.scale(&self.joints, &mut self.load_coefficient, |_| [f64::NEG_INFINITY, 0.45]);
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        for (joint, coefficient) in self.joints.iter().zip(&self.load_coefficient) {
            setup.machine.joints[*joint].load_coefficient = [*coefficient; 2];
        }
        Ok(())
    }
}
