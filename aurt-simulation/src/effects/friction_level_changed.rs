use super::declaring::*;
use crate::plant::ViscousLaw;

/// Dry and viscous friction multiplied by 1 + change.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrictionLevelChanged {
    pub joints: Vec<usize>,
    /// Relative change of Coulomb friction.
    pub coulomb_change: Vec<f64>,
    /// Relative change of viscous friction.
    pub viscous_change: Vec<f64>,
}

impl Physics for FrictionLevelChanged {
    const KIND: Declaration =
        Declaration::new("friction_level_changed", Family::F, Presence::Later, Takes::Few);
    const VALUES: &'static [(&'static str, [f64; 2])] =
        &[("coulomb_change", [-1.0, 10.0]), ("viscous_change", [-1.0, 10.0])];

    fn draw(context: &Draw<'_>, random: &mut Random) -> Self {
        let change = |random: &mut Random| random.between(0.08, 0.25);
        let sign = random.sign();
        let (dry, viscous) = (sign * change(random), sign * change(random));
        let joints = context.joints.len();
        Self {
            joints: context.joints.to_vec(),
            coulomb_change: vec![dry; joints],
            viscous_change: vec![viscous; joints],
        }
    }

    fn scale(&mut self, factor: Factor<'_>, _robot: &Robot) {
        let joints = self.joints.iter().chain(&self.joints);
        for (joint, change) in joints.zip(self.coulomb_change.iter_mut().chain(&mut self.viscous_change)) {
            *change = (*change * factor.on(*joint)).clamp(-0.8, 3.0);
        }
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        for ((joint, dry), viscous) in self.joints.iter().zip(&self.coulomb_change).zip(&self.viscous_change)
        {
            let physics = &mut setup.machine.joints[*joint];
            physics.coulomb_nm = physics.coulomb_nm.map(|level| level * (1.0 + dry));
            physics.load_coefficient = physics.load_coefficient.map(|c| c * (1.0 + dry));
            let before = std::mem::replace(&mut physics.viscous, Box::new(crate::plant::LinearViscous(0.0)));
            physics.viscous = Box::new(Scaled { law: before, factor: 1.0 + viscous });
        }
        Ok(())
    }
}

#[derive(Debug)]
struct Scaled {
    law: Box<dyn ViscousLaw>,
    factor: f64,
}

impl ViscousLaw for Scaled {
    fn torque_nm(&self, velocity_rad_s: f64) -> f64 {
        self.factor * self.law.torque_nm(velocity_rad_s)
    }

    fn steepest_nm_s(&self) -> f64 {
        self.factor * self.law.steepest_nm_s()
    }
}
