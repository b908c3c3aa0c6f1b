use super::declaring::*;

/// A rotor behind the gear, beside those that the robot has.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RotorInertia {
    pub joints: Vec<usize>,
    /// Inertia on the joint's side, kg m².
    pub inertia_kg_m2: Vec<f64>,
}

impl Physics for RotorInertia {
    const IDENTIFIER: &'static str = "rotor_inertia";
    const FAMILY: Family = Family::I;
    const SUMMARY: &'static str = "inertia of a geared rotor";
    const PRESENCE: Presence = Presence::Structural;
    const ROTORS: Option<Rotors> = Some(Rotors::InLinks);
    const TAKES: Takes = Takes::Few;
    const PARAMETERS: &'static [&'static str] = &["inertia_kg_m2"];
    const VALUES: &'static [(&'static str, [f64; 2])] = &[("inertia_kg_m2", [0.0, 1e3])];

    fn draw(context: &Draw<'_>, _random: &mut Random) -> Self {
        Self { joints: context.joints.to_vec(), inertia_kg_m2: context.noises(0.7) }
    }

    fn scale(&mut self, factor: Factor<'_>, _robot: &Robot) {
        factor.scale(&self.joints, &mut self.inertia_kg_m2, |_| [f64::NEG_INFINITY, 6.0]);
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        for (joint, inertia) in self.joints.iter().zip(&self.inertia_kg_m2) {
            setup.machine.robot.drives[*joint].rotor_inertia_kg_m2 += inertia;
            setup.machine.nominal.drives[*joint].rotor_inertia_kg_m2 += inertia;
        }
        Ok(())
    }
}
