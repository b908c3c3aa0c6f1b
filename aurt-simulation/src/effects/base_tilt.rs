use super::declaring::*;

/// The base turned about its x axis by roll and then about its own y axis by pitch: in the base frame gravity
/// is (R_x(roll) R_y(pitch))ᵀ g.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BaseTilt {
    pub roll_rad: f64,
    pub pitch_rad: f64,
}

/// Largest tilt, rad.
const LARGEST_RAD: f64 = 0.6;

impl BaseTilt {
    /// What gravity becomes in the base frame.
    pub fn tilted(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let (sr, cr) = (libm::sin(self.roll_rad), libm::cos(self.roll_rad));
        let (sp, cp) = (libm::sin(self.pitch_rad), libm::cos(self.pitch_rad));
        let (y, z) = (cr * y + sr * z, cr * z - sr * y);
        [cp * x - sp * z, y, sp * x + cp * z]
    }
}

impl Physics for BaseTilt {
    const KIND: Declaration = Declaration::new("base_tilt", Family::I, Presence::Either, Takes::All);
    const PARAMETERS: &'static [&'static str] = &["roll_rad", "pitch_rad"];

    fn draw(_context: &Draw<'_>, random: &mut Random) -> Self {
        let size = random.between(0.03, 0.07);
        let direction = random.between(0.0, std::f64::consts::TAU);
        Self { roll_rad: size * libm::cos(direction), pitch_rad: size * libm::sin(direction) }
    }

    fn scale(&mut self, factor: Factor<'_>, _robot: &Robot) {
        let size = (self.roll_rad * self.roll_rad + self.pitch_rad * self.pitch_rad).sqrt();
        let factor = factor.on(0).min(LARGEST_RAD / size.max(1e-12));
        self.roll_rad *= factor;
        self.pitch_rad *= factor;
    }

    fn check(&self, complaints: &mut Checks<'_>) {
        complaints.within("roll of the base in rad", self.roll_rad, -3.2, 3.2);
        complaints.within("pitch of the base in rad", self.pitch_rad, -3.2, 3.2);
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        let robot = &mut setup.machine.robot;
        robot.gravity_m_s2 = self.tilted(robot.gravity_m_s2);
        Ok(())
    }
}
