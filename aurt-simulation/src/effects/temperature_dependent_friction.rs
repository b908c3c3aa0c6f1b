use super::declaring::*;
use crate::plant::Warmth;
use crate::robots::Drive;

/// Friction heats the lubricant, and warm lubricant has less friction. Every recording begins cold.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TemperatureDependentFriction {
    pub joints: Vec<usize>,
    /// Relative fall of viscous friction per kelvin; dry friction falls by `dry_share` of it.
    pub fall_per_k: Vec<f64>,
    /// Share of the fall that dry friction has.
    pub dry_share: f64,
    /// Time constants of lubricant and housing, s.
    pub time_constants_s: [f64; 2],
}

/// What friction at half the largest speed heats the lubricant to if no heat left it, K per quick time constant.
const WARMING_K: f64 = 15.0;

impl TemperatureDependentFriction {
    /// How the friction of a drive falls as it warms up.
    pub fn warmth(&self, drive: &Drive, fall_per_k: f64) -> Warmth {
        let speed = 0.5 * drive.velocity_limit_rad_s;
        let power = (drive.coulomb_nm + drive.viscous_nm_s * speed) * speed;
        Warmth {
            heating_k_per_j: WARMING_K / (power.max(1e-6) * self.time_constants_s[0]),
            time_constants_s: self.time_constants_s,
            fall_per_k: [self.dry_share * fall_per_k, fall_per_k],
            start_k: [0.0; 2],
        }
    }
}

impl Physics for TemperatureDependentFriction {
    const KIND: Declaration =
        Declaration::new("temperature_dependent_friction", Family::V, Presence::Structural, Takes::Few);
    const VALUES: &'static [(&'static str, [f64; 2])] = &[("fall_per_k", [0.0, 0.5])];

    fn draw(context: &Draw<'_>, random: &mut Random) -> Self {
        let (least, most) = if context.continuous() { (0.1, 2.0) } else { (0.25, 0.7) };
        let quick = context.duration_s * random.between(least, most);
        let fall = random.between(0.015, 0.03);
        Self {
            joints: context.joints.to_vec(),
            fall_per_k: vec![fall; context.joints.len()],
            dry_share: random.between(if context.continuous() { 0.0 } else { 0.4 }, 1.0),
            time_constants_s: [
                quick,
                if context.continuous() { random.between(2.0, 15.0) } else { 8.0 } * quick,
            ],
        }
    }

    fn scale(&mut self, factor: Factor<'_>, _robot: &Robot) {
        factor.scale(&self.joints, &mut self.fall_per_k, |_| [f64::NEG_INFINITY, 0.12]);
    }

    fn check(&self, complaints: &mut Checks<'_>) {
        complaints.within("share of dry friction in warming", self.dry_share, 0.0, 2.0);
        for constant in self.time_constants_s {
            complaints.within("time constant of warming in s", constant, 0.1, 1e6);
        }
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        for (joint, fall) in self.joints.iter().zip(&self.fall_per_k) {
            let drive = &setup.machine.nominal.drives[*joint];
            setup.machine.joints[*joint].warmth = Some(self.warmth(drive, *fall));
        }
        Ok(())
    }
}
