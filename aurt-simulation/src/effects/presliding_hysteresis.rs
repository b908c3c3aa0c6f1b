use super::declaring::*;
use crate::plant::Bristle;
use crate::plant::bristles::{Gms, LuGre, Masing};

/// Which model moves the bristles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BristleModel {
    Lugre,
    /// Generalised Maxwell slip, eight elements.
    Gms,
    Masing,
}

/// Dry friction with presliding in the place of the jump at zero velocity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PreslidingHysteresis {
    pub joints: Vec<usize>,
    /// Distance over which friction builds up, rad.
    pub distance_rad: Vec<f64>,
    pub model: BristleModel,
    /// Damping of the bristles as a share of the robot's viscous friction (LuGre alone).
    pub damping_share: f64,
}

/// Shortest and longest distance, rad.
const DISTANCES_RAD: (f64, f64) = (1e-4, 0.12);

impl PreslidingHysteresis {
    /// The bristle of a joint whose dry friction has a level.
    pub fn bristle(&self, distance_rad: f64, level_nm: f64, viscous_nm_s: f64) -> Box<dyn Bristle> {
        match self.model {
            BristleModel::Lugre => Box::new(LuGre {
                stiffness_nm_rad: level_nm / (0.5 * distance_rad),
                damping_nm_s: self.damping_share * viscous_nm_s,
            }),
            BristleModel::Gms => {
                // Elements that let go at distances in geometric progression.
                let distances: Vec<f64> = [0.12, 0.2, 0.32, 0.5, 0.8, 1.2, 1.8, 2.6]
                    .iter()
                    .map(|d| d * 0.8 * distance_rad)
                    .collect();
                Box::new(Gms::from_displacements(
                    level_nm,
                    &distances,
                    &[0.1, 0.12, 0.14, 0.16, 0.16, 0.14, 0.1, 0.08],
                ))
            }
            BristleModel::Masing => Box::new(Masing { half_way_rad: 0.25 * distance_rad }),
        }
    }
}

impl Physics for PreslidingHysteresis {
    const KIND: Declaration =
        Declaration::new("presliding_hysteresis", Family::H, Presence::Structural, Takes::Few);
    const VALUES: &'static [(&'static str, [f64; 2])] = &[("distance_rad", [1e-5, 1.0])];

    fn draw(context: &Draw<'_>, random: &mut Random) -> Self {
        let model = match random.index(3) {
            0 => BristleModel::Lugre,
            1 => BristleModel::Gms,
            _ => BristleModel::Masing,
        };
        let distance = if context.continuous() {
            random.between_logs(0.003, 0.05)
        } else {
            random.between(0.006, 0.012)
        };
        let damping = if context.continuous() { 0.8 } else { 0.3 };
        Self {
            joints: context.joints.to_vec(),
            distance_rad: vec![distance; context.joints.len()],
            model,
            damping_share: random.between(0.0, damping),
        }
    }

    fn scale(&mut self, factor: Factor<'_>, _robot: &Robot) {
        factor.scale(&self.joints, &mut self.distance_rad, |_| [DISTANCES_RAD.0, DISTANCES_RAD.1]);
    }

    fn check(&self, complaints: &mut Checks<'_>) {
        complaints.within("damping of the bristles", self.damping_share, 0.0, 1.0);
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        for (joint, distance) in self.joints.iter().zip(&self.distance_rad) {
            let viscous = setup.machine.nominal.drives[*joint].viscous_nm_s;
            let physics = &mut setup.machine.joints[*joint];
            if physics.bristle.is_some() {
                let reason = "friction has one memory";
                return Err(conflict(Self::KIND.identifier, Self::KIND.identifier, *joint, reason));
            }
            let level = 0.5 * (physics.coulomb_nm[0] + physics.coulomb_nm[1]);
            if level <= 0.0 {
                let reason = "there is no dry friction that could build up";
                return Err(conflict(Self::KIND.identifier, "absent Coulomb friction", *joint, reason));
            }
            physics.bristle = Some(self.bristle(*distance, level, viscous));
        }
        Ok(())
    }
}
