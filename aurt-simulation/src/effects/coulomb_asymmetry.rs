use super::declaring::*;

/// Dry friction that is higher in one direction by as much as it is lower in the other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CoulombAsymmetry {
    pub joints: Vec<usize>,
    /// What the positive direction has more than the mean, Nm; negative for less.
    pub half_difference_nm: Vec<f64>,
    /// Mean level, Nm.
    pub mean_nm: Vec<f64>,
}

impl Physics for CoulombAsymmetry {
    const KIND: Declaration = Declaration::new("coulomb_asymmetry", Family::F, Presence::Either, Takes::Few);
    const VALUES: &'static [(&'static str, [f64; 2])] =
        &[("mean_nm", [0.0, 1e4]), ("half_difference_nm", [-1e4, 1e4])];

    fn draw(context: &Draw<'_>, random: &mut Random) -> Self {
        Self {
            joints: context.joints.to_vec(),
            half_difference_nm: context.noises(random.sign()),
            mean_nm: context.joints.iter().map(|j| context.robot.drives[*j].coulomb_nm).collect(),
        }
    }

    fn parameters(&self) -> Vec<(&'static str, Vec<f64>)> {
        let [positive, negative] = both_directions(&self.mean_nm, &self.half_difference_nm);
        vec![("coulomb_pos_nm", positive), ("coulomb_neg_nm", negative)]
    }

    fn scale(&mut self, factor: Factor<'_>, _robot: &Robot) {
        scale_difference(factor, &self.joints, &mut self.half_difference_nm, &self.mean_nm);
    }

    fn check(&self, complaints: &mut Checks<'_>) {
        let difference = ("half_difference_nm", &self.half_difference_nm[..]);
        check_difference(complaints, &self.joints, difference, &self.mean_nm, ("level", "Nm"));
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        for ((joint, half), mean) in self.joints.iter().zip(&self.half_difference_nm).zip(&self.mean_nm) {
            setup.machine.joints[*joint].coulomb_nm = [mean + half, mean - half];
        }
        Ok(())
    }
}

/// Values in the positive direction and in the negative one.
pub(super) fn both_directions(means: &[f64], halves: &[f64]) -> [Vec<f64>; 2] {
    [1.0, -1.0].map(|sign| means.iter().zip(halves).map(|(mean, half)| mean + sign * half).collect())
}

/// Multiplies half differences, and keeps friction from turning into drive.
pub(super) fn scale_difference(factor: Factor<'_>, joints: &[usize], halves: &mut [f64], means: &[f64]) {
    for ((joint, half), mean) in joints.iter().zip(halves).zip(means) {
        *half = (*half * factor.on(*joint)).clamp(-0.95 * mean, 0.95 * mean);
    }
}

/// Complains about half differences with which friction would push; `what` the mean is, and its unit.
pub(super) fn check_difference(
    complaints: &mut Checks<'_>,
    joints: &[usize],
    (name, halves): (&str, &[f64]),
    means: &[f64],
    (what, unit): (&str, &str),
) {
    for ((joint, half), mean) in joints.iter().zip(halves).zip(means) {
        if half.abs() > *mean {
            let reason = format!("beyond the mean {what} of {mean} {unit} friction would push");
            complaints.0.push(SimulationError::value(format!("{name} of joint {joint}"), *half, reason));
        }
    }
}
