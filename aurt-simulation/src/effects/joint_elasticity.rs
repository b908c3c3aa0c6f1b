use super::declaring::*;
use crate::plant::Gear;

/// A gear of spring and damper between motor and link; the encoder sits on the motor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointElasticity {
    pub joints: Vec<usize>,
    pub stiffness_nm_rad: Vec<f64>,
    /// Damping, Nm s/rad.
    pub damping_nm_s: Vec<f64>,
}

/// Share of the rotor's inertia that a link needs for its gear's spring to be a mode of its own, and not a
/// rattle of the gear alone.
const LEAST_LINK_SHARE: f64 = 0.03;
/// Least inertia of such a link, kg m².
const LEAST_LINK_KG_M2: f64 = 0.004;

/// Whether a link is heavy enough to swing on its gear.
pub(super) fn heavy_link(robot: &Robot, joint: usize) -> bool {
    let rotor = robot.drives[joint].rotor_inertia_kg_m2;
    robot
        .link_inertia_kg_m2()
        .is_ok_and(|links| links[joint] > LEAST_LINK_KG_M2 && links[joint] > LEAST_LINK_SHARE * rotor)
}

/// Damping of a gear for a damping ratio of the swing of rotor against link.
pub(super) fn gear_damping_nm_s(robot: &Robot, joint: usize, stiffness_nm_rad: f64, ratio: f64) -> f64 {
    let rotor = robot.drives[joint].rotor_inertia_kg_m2;
    let link = robot.link_inertia_kg_m2().map_or(rotor, |links| links[joint]);
    2.0 * ratio * (stiffness_nm_rad * rotor * link / (rotor + link).max(1e-12)).sqrt()
}

impl Physics for JointElasticity {
    const KIND: Declaration =
        Declaration::new("joint_elasticity", Family::P, Presence::Structural, Takes::Few);
    const ROTORS: Option<Rotors> = Some(Rotors::Geared);
    const PARAMETERS: &'static [&'static str] = &["stiffness_nm_rad", "damping_nm_s"];
    const SUITS: fn(&Robot, usize) -> bool = heavy_link;
    const VALUES: &'static [(&'static str, [f64; 2])] =
        &[("stiffness_nm_rad", [1.0, 1e7]), ("damping_nm_s", [0.0, 1e4])];

    fn draw(context: &Draw<'_>, random: &mut Random) -> Self {
        let drives = || context.joints.iter().map(|j| &context.robot.drives[*j]);
        let softer = random.between(3.0, 6.0);
        let damping = random.between(0.02, 0.06);
        Self {
            joints: context.joints.to_vec(),
            stiffness_nm_rad: drives().map(|d| d.gear_stiffness_nm_rad / softer).collect(),
            damping_nm_s: context
                .joints
                .iter()
                .zip(drives())
                .map(|(j, d)| gear_damping_nm_s(context.robot, *j, d.gear_stiffness_nm_rad / softer, damping))
                .collect(),
        }
    }

    fn scale(&mut self, factor: Factor<'_>, robot: &Robot) {
        let stiffnesses = self.stiffness_nm_rad.iter_mut().zip(&mut self.damping_nm_s);
        for (joint, (stiffness, damping)) in self.joints.iter().zip(stiffnesses) {
            let data_sheet = robot.drives[*joint].gear_stiffness_nm_rad;
            let softer =
                (*stiffness / factor.on(*joint).max(1e-12)).clamp(0.02 * data_sheet, 3.0 * data_sheet);
            *damping *= (softer / *stiffness).sqrt();
            *stiffness = softer;
        }
    }

    fn check(&self, complaints: &mut Checks<'_>) {
        check_rotors(complaints, Self::KIND.identifier, &self.joints);
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        for ((joint, stiffness), damping) in
            self.joints.iter().zip(&self.stiffness_nm_rad).zip(&self.damping_nm_s)
        {
            make_compliant(setup, Self::KIND.identifier, *joint, *stiffness, *damping, 0.0)?;
        }
        Ok(())
    }
}

/// Complains about joints without a rotor of their own.
pub(super) fn check_rotors(complaints: &mut Checks<'_>, effect: &str, joints: &[usize]) {
    let robot = complaints.robot;
    for joint in joints.iter().filter(|j| **j < robot.joints()) {
        let inertia = robot.drives[*joint].rotor_inertia_kg_m2;
        if inertia <= 0.0 {
            let what = format!("rotor inertia of joint {joint}");
            let reason = format!("`{effect}` needs a rotor with inertia before the gear");
            complaints.0.push(SimulationError::value(what, inertia, reason));
        }
    }
}

/// Gives a joint a compliant gear.
pub(super) fn make_compliant(
    setup: &mut Setup,
    effect: &str,
    joint: usize,
    stiffness_nm_rad: f64,
    damping_nm_s: f64,
    half_gap_rad: f64,
) -> Result<(), SimulationError> {
    if setup.machine.couplings.iter().any(|c| c.ratios.iter().any(|(j, _)| *j == joint)) {
        let reason = "a coupled rotor needs rigid gears";
        return Err(conflict(effect, "joint_coupling_friction", joint, reason));
    }
    let gear = &mut setup.machine.joints[joint].gear;
    *gear = match *gear {
        Gear::Rigid => Gear::Compliant { stiffness_nm_rad, damping_nm_s, half_gap_rad },
        // A spring and play in one gear: the softer spring, the wider play.
        Gear::Compliant { stiffness_nm_rad: k, damping_nm_s: d, half_gap_rad: g } => Gear::Compliant {
            stiffness_nm_rad: k.min(stiffness_nm_rad),
            damping_nm_s: if k < stiffness_nm_rad { d } else { damping_nm_s },
            half_gap_rad: g.max(half_gap_rad),
        },
    };
    Ok(())
}
