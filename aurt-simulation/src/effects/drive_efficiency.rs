use super::declaring::*;

/// Gear losses in proportion to the transmitted torque, of two sizes: while the motor drives the load, and
/// while the load drives the motor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriveEfficiency {
    pub joints: Vec<usize>,
    /// Loss per load while driving, Nm/Nm.
    pub driving: Vec<f64>,
    /// Loss per load while driven, Nm/Nm.
    pub driven: Vec<f64>,
}

impl Physics for DriveEfficiency {
    const KIND: Declaration =
        Declaration::new("drive_efficiency", Family::L, Presence::Structural, Takes::Few);
    const PARAMETERS: &'static [&'static str] = &["driving", "driven"];
    const SUITS: fn(&Robot, usize) -> bool = constant_level;
    const VALUES: &'static [(&'static str, [f64; 2])] = &[("driving", [0.0, 0.9]), ("driven", [0.0, 0.9])];

    fn draw(context: &Draw<'_>, random: &mut Random) -> Self {
        let (large, small) = (random.between(0.1, 0.2), random.between(0.01, 0.05));
        let (driving, driven) = if random.chance(0.5) { (large, small) } else { (small, large) };
        let joints = context.joints.len();
        Self { joints: context.joints.to_vec(), driving: vec![driving; joints], driven: vec![driven; joints] }
    }

    fn scale(&mut self, factor: Factor<'_>, _robot: &Robot) {
        for (joint, (a, b)) in self.joints.iter().zip(self.driving.iter_mut().zip(&mut self.driven)) {
            let factor = factor.on(*joint).min(0.5 / a.max(*b).max(1e-9));
            (*a, *b) = (*a * factor, *b * factor);
        }
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        for ((joint, driving), driven) in self.joints.iter().zip(&self.driving).zip(&self.driven) {
            setup.machine.joints[*joint].load_coefficient = [*driving, *driven];
        }
        Ok(())
    }
}
