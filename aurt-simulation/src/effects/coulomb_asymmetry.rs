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
    const IDENTIFIER: &'static str = "coulomb_asymmetry";
    const FAMILY: Family = Family::F;
    const SUMMARY: &'static str = "dry friction of two levels, one for each direction";
    const PRESENCE: Presence = Presence::Either;
    const TAKES: Takes = Takes::Few;

    fn draw(context: &Draw<'_>, random: &mut Random) -> Self {
        Self {
            joints: context.joints.to_vec(),
            half_difference_nm: context.noises(random.sign()),
            mean_nm: context.joints.iter().map(|j| context.robot.drives[*j].coulomb_nm).collect(),
        }
    }

    fn parameters(&self) -> Vec<(&'static str, Vec<f64>)> {
        let with = |sign: f64| {
            self.mean_nm.iter().zip(&self.half_difference_nm).map(|(mean, half)| mean + sign * half).collect()
        };
        vec![("coulomb_pos_nm", with(1.0)), ("coulomb_neg_nm", with(-1.0))]
    }

    fn scale(&mut self, factor: Factor<'_>, _robot: &Robot) {
        for ((joint, half), mean) in self.joints.iter().zip(&mut self.half_difference_nm).zip(&self.mean_nm) {
            *half = (*half * factor.on(*joint)).clamp(-0.95 * mean, 0.95 * mean);
        }
    }

    fn check(&self, complaints: &mut Checks<'_>) {
        complaints.values("mean_nm", &self.mean_nm, (0.0, 1e4));
        let (half, bounds) = (&self.half_difference_nm, (-1e4, 1e4));
        complaints.values("half_difference_nm", half, bounds);
        for ((joint, half), mean) in self.joints.iter().zip(half).zip(&self.mean_nm) {
            if half.abs() > *mean {
                let what = format!("half_difference_nm of joint {joint}");
                let reason = format!("beyond the mean level of {mean} Nm friction would push");
                complaints.0.push(SimulationError::value(what, *half, reason));
            }
        }
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        for ((joint, half), mean) in self.joints.iter().zip(&self.half_difference_nm).zip(&self.mean_nm) {
            setup.machine.joints[*joint].coulomb_nm = [mean + half, mean - half];
        }
        Ok(())
    }
}
