use super::declaring::*;
use crate::plant::ViscousLaw;

/// Viscous friction of a lubricant that follows Eyring's law (1936): stress ∝ asinh(shear rate).
///
/// f = F_v q̇ + A (asinh(q̇/v_0) − asinh(v_1/v_0) q̇/v_1), so that at the speed v_1 the torque is that of the
/// linear law and A is the size of the bend alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ViscousNonlinear {
    pub joints: Vec<usize>,
    pub bend_nm: Vec<f64>,
    /// F_v, Nm s/rad.
    pub slope_nm_s: Vec<f64>,
    /// v_1, rad/s.
    pub reference_rad_s: Vec<f64>,
    /// v_0 / v_1.
    pub onset: f64,
}

impl ViscousNonlinear {
    fn law(&self, i: usize) -> Eyring {
        let (reference, bend) = (self.reference_rad_s[i], self.bend_nm[i]);
        let onset_rad_s = self.onset * reference;
        Eyring {
            bend_nm: bend,
            onset_rad_s,
            slope_nm_s: self.slope_nm_s[i] - bend * libm::asinh(1.0 / self.onset) / reference,
        }
    }

    /// The largest bend for which friction still grows with speed everywhere.
    fn largest_bend_nm(&self, i: usize) -> f64 {
        self.slope_nm_s[i] * self.reference_rad_s[i] / libm::asinh(1.0 / self.onset)
    }
}

impl Physics for ViscousNonlinear {
    const KIND: Declaration =
        Declaration::new("viscous_nonlinear", Family::V, Presence::Structural, Takes::Few);
    const VALUES: &'static [(&'static str, [f64; 2])] =
        &[("bend_nm", [0.0, 1e4]), ("slope_nm_s", [0.0, 1e4]), ("reference_rad_s", [1e-3, 1e3])];

    fn draw(context: &Draw<'_>, random: &mut Random) -> Self {
        let drives = || context.joints.iter().map(|j| &context.robot.drives[*j]);
        let mut effect = Self {
            joints: context.joints.to_vec(),
            bend_nm: context.noises(3.0),
            slope_nm_s: drives().map(|d| d.viscous_nm_s).collect(),
            reference_rad_s: drives().map(|d| 0.5 * d.velocity_limit_rad_s).collect(),
            onset: if context.continuous() { random.between(0.03, 0.6) } else { random.between(0.08, 0.25) },
        };
        effect.scale(Factor::Uniform(1.0), context.robot);
        effect
    }

    fn scale(&mut self, factor: Factor<'_>, _robot: &Robot) {
        for i in 0..self.bend_nm.len() {
            self.bend_nm[i] =
                (self.bend_nm[i] * factor.on(self.joints[i])).min(0.98 * self.largest_bend_nm(i));
        }
    }

    fn check(&self, complaints: &mut Checks<'_>) {
        let (name, joints) = (Self::KIND.identifier, &self.joints);
        complaints.within("onset of the bend", self.onset, 1e-3, 10.0);
        if !complaints.0.is_empty() {
            return;
        }
        for (i, joint) in joints.iter().enumerate() {
            let most = self.largest_bend_nm(i);
            complaints.within(format!("`bend_nm` of `{name}` on joint {joint}"), self.bend_nm[i], 0.0, most);
        }
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        for (i, joint) in self.joints.iter().enumerate() {
            setup.machine.joints[*joint].viscous = Box::new(self.law(i));
        }
        Ok(())
    }
}

#[derive(Debug)]
struct Eyring {
    bend_nm: f64,
    onset_rad_s: f64,
    slope_nm_s: f64,
}

impl ViscousLaw for Eyring {
    fn torque_nm(&self, velocity_rad_s: f64) -> f64 {
        self.slope_nm_s * velocity_rad_s + self.bend_nm * libm::asinh(velocity_rad_s / self.onset_rad_s)
    }

    fn steepest_nm_s(&self) -> f64 {
        self.slope_nm_s + self.bend_nm / self.onset_rad_s
    }
}
