use super::declaring::*;
use crate::plant::{DryTerm, Instant};

/// Dry friction that falls with speed from F_C + excess at rest: excess / (1 + (|q̇|/v_S)^δ).
///
/// This is the form of Hess and Soom (1990); exponentials are what is usually fitted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stribeck {
    pub joints: Vec<usize>,
    /// Static less Coulomb friction, Nm.
    pub excess_nm: Vec<f64>,
    /// Coulomb level, Nm.
    pub coulomb_nm: Vec<f64>,
    /// v_S: speed at which half the excess is gone, rad/s.
    pub stribeck_velocity_rad_s: f64,
    /// δ.
    pub exponent: f64,
}

impl Physics for Stribeck {
    const KIND: Declaration = Declaration::new("stribeck", Family::F, Presence::Structural, Takes::Few);
    const VALUES: &'static [(&'static str, [f64; 2])] =
        &[("excess_nm", [0.0, 1e4]), ("coulomb_nm", [0.0, 1e4])];

    fn draw(context: &Draw<'_>, random: &mut Random) -> Self {
        let (stribeck_velocity_rad_s, exponent) = if context.continuous() {
            (random.between_logs(0.01, 0.15), random.between(0.5, 2.0))
        } else {
            (random.between(0.03, 0.1), random.between(1.3, 2.2))
        };
        let mut effect = Self {
            joints: context.joints.to_vec(),
            excess_nm: context.noises(3.0),
            coulomb_nm: context.joints.iter().map(|j| context.robot.drives[*j].coulomb_nm).collect(),
            stribeck_velocity_rad_s,
            exponent,
        };
        effect.scale(Factor::Uniform(1.0), context.robot);
        effect
    }

    fn parameters(&self) -> Vec<(&'static str, Vec<f64>)> {
        let rest = self.coulomb_nm.iter().zip(&self.excess_nm).map(|(coulomb, excess)| coulomb + excess);
        vec![
            ("half_speed_rad_s", vec![self.stribeck_velocity_rad_s; self.joints.len()]),
            ("static_nm", rest.collect()),
        ]
    }

    fn scale(&mut self, factor: Factor<'_>, _robot: &Robot) {
        for ((joint, excess), coulomb) in self.joints.iter().zip(&mut self.excess_nm).zip(&self.coulomb_nm) {
            *excess = (*excess * factor.on(*joint)).min(1.5 * coulomb);
        }
    }

    fn check(&self, complaints: &mut Checks<'_>) {
        complaints.within("Stribeck velocity in rad/s", self.stribeck_velocity_rad_s, 1e-3, 2.0);
        complaints.within("exponent of the Stribeck curve", self.exponent, 0.3, 4.0);
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        for ((joint, excess), coulomb) in self.joints.iter().zip(&self.excess_nm).zip(&self.coulomb_nm) {
            let physics = &mut setup.machine.joints[*joint];
            physics.coulomb_nm = [*coulomb; 2];
            physics.dry_terms.push(Box::new(Curve {
                excess_nm: *excess,
                velocity_rad_s: self.stribeck_velocity_rad_s,
                exponent: self.exponent,
            }));
        }
        Ok(())
    }
}

/// Static friction above Coulomb friction: excess / (1 + |q̇/v|^δ).
#[derive(Debug)]
pub struct Curve {
    /// Static less Coulomb friction, Nm.
    pub excess_nm: f64,
    /// v, rad/s.
    pub velocity_rad_s: f64,
    /// δ.
    pub exponent: f64,
}

impl DryTerm for Curve {
    fn level_nm(&self, joint: usize, at: &Instant<'_>, _direction: f64) -> f64 {
        let x = at.shaft_rad_s[joint].abs() / self.velocity_rad_s;
        self.excess_nm / (1.0 + libm::pow(x, self.exponent))
    }
}
