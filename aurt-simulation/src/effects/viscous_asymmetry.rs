use super::coulomb_asymmetry::{both_directions, check_difference, scale_difference};
use super::declaring::*;
use crate::plant::ViscousLaw;

/// Viscous friction that is steeper in one direction by as much as it is flatter in the other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ViscousAsymmetry {
    pub joints: Vec<usize>,
    /// What the positive direction has more than the mean, Nm s/rad; negative for less.
    pub half_difference_nm_s: Vec<f64>,
    /// Mean slope, Nm s/rad.
    pub mean_nm_s: Vec<f64>,
}

impl Physics for ViscousAsymmetry {
    const KIND: Declaration = Declaration::new("viscous_asymmetry", Family::V, Presence::Either, Takes::Few);
    const VALUES: &'static [(&'static str, [f64; 2])] =
        &[("mean_nm_s", [0.0, 1e4]), ("half_difference_nm_s", [-1e4, 1e4])];

    fn draw(context: &Draw<'_>, random: &mut Random) -> Self {
        let mut effect = Self {
            joints: context.joints.to_vec(),
            half_difference_nm_s: context.noises(2.0 * random.sign()),
            mean_nm_s: context.joints.iter().map(|j| context.robot.drives[*j].viscous_nm_s).collect(),
        };
        effect.scale(Factor::Uniform(1.0), context.robot);
        effect
    }

    fn parameters(&self) -> Vec<(&'static str, Vec<f64>)> {
        let [positive, negative] = both_directions(&self.mean_nm_s, &self.half_difference_nm_s);
        vec![("viscous_pos_nm_s", positive), ("viscous_neg_nm_s", negative)]
    }

    fn scale(&mut self, factor: Factor<'_>, _robot: &Robot) {
        scale_difference(factor, &self.joints, &mut self.half_difference_nm_s, &self.mean_nm_s);
    }

    fn check(&self, complaints: &mut Checks<'_>) {
        let difference = ("half_difference_nm_s", &self.half_difference_nm_s[..]);
        check_difference(complaints, &self.joints, difference, &self.mean_nm_s, ("slope", "Nm s/rad"));
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        for ((joint, half), mean) in self.joints.iter().zip(&self.half_difference_nm_s).zip(&self.mean_nm_s) {
            let law = TwoSlopes { positive_nm_s: mean + half, negative_nm_s: mean - half };
            setup.machine.joints[*joint].viscous = Box::new(law);
        }
        Ok(())
    }
}

#[derive(Debug)]
struct TwoSlopes {
    positive_nm_s: f64,
    negative_nm_s: f64,
}

impl ViscousLaw for TwoSlopes {
    fn torque_nm(&self, velocity_rad_s: f64) -> f64 {
        velocity_rad_s * if velocity_rad_s < 0.0 { self.negative_nm_s } else { self.positive_nm_s }
    }

    fn steepest_nm_s(&self) -> f64 {
        self.positive_nm_s.max(self.negative_nm_s)
    }
}
