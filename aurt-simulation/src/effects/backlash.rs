use super::declaring::*;
use super::joint_elasticity::{check_rotors, gear_damping_nm_s, heavy_link, make_compliant};

/// Play in a gear whose flanks are stiff and damped; the encoder sits on the motor.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Backlash {
    pub joint: usize,
    /// Half the play, rad.
    pub gap_rad: f64,
    /// Stiffness of the flanks, Nm/rad.
    pub stiffness_nm_rad: f64,
    /// Damping of the flanks, Nm s/rad.
    pub damping_nm_s: f64,
}

impl Physics for Backlash {
    const KIND: Declaration = Declaration::new("backlash", Family::P, Presence::Either, Takes::One);
    const ROTORS: Option<Rotors> = Some(Rotors::Geared);
    const PARAMETERS: &'static [&'static str] = &["gap_rad"];
    const SUITS: fn(&Robot, usize) -> bool = heavy_link;

    fn draw(context: &Draw<'_>, random: &mut Random) -> Self {
        let (joint, drive) = context.drive();
        let stiffness = drive.gear_stiffness_nm_rad;
        Self {
            joint,
            gap_rad: random.between(0.0015, 0.003),
            stiffness_nm_rad: stiffness,
            damping_nm_s: gear_damping_nm_s(context.robot, joint, stiffness, random.between(0.1, 0.3)),
        }
    }

    fn scale(&mut self, factor: Factor<'_>, _robot: &Robot) {
        self.gap_rad = (self.gap_rad * factor.on(self.joint)).clamp(5e-5, 0.03);
    }

    fn check(&self, complaints: &mut Checks<'_>) {
        check_rotors(complaints, Self::KIND.identifier, &[self.joint]);
        complaints.within("play of the gear in rad", self.gap_rad, 0.0, 0.5);
        complaints.within("stiffness of the flanks in Nm/rad", self.stiffness_nm_rad, 1.0, 1e7);
        complaints.within("damping of the flanks in Nm s/rad", self.damping_nm_s, 0.0, 1e4);
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        let Self { joint, gap_rad, stiffness_nm_rad, damping_nm_s } = *self;
        make_compliant(setup, Self::KIND.identifier, joint, stiffness_nm_rad, damping_nm_s, gap_rad)
    }
}
