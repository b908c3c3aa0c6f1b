//! The machine that is simulated: a robot and the physics that acts in its drives.

use std::fmt::Debug;

use crate::plant::warmth::Warmth;
use crate::robots::Robot;

/// What the physics of a drive may depend on at one instant. Shafts are the motors' side of the gears, in
/// joint units; they equal the joints unless a gear is elastic or has play.
#[derive(Debug, Clone, Copy)]
pub struct Instant<'a> {
    /// Time since the start of the recording, s.
    pub time_s: f64,
    /// Shaft angles, rad.
    pub shaft_rad: &'a [f64],
    /// Shaft velocities, rad/s.
    pub shaft_rad_s: &'a [f64],
    /// Joint angles, rad.
    pub q_rad: &'a [f64],
    /// Joint velocities, rad/s.
    pub qd_rad_s: &'a [f64],
    /// Joint accelerations at the last completed step, rad/s².
    pub last_qdd_rad_s2: &'a [f64],
}

/// A smooth torque that shafts have to overcome.
pub trait ShaftTorque: Debug + Send + Sync {
    /// Adds the torque that opposes the motors, Nm, N entries.
    fn add(&self, at: &Instant<'_>, opposing_nm: &mut [f64]);

    /// The fastest rate that the torque gives a shaft whose inertia is `inertia_kg_m2(joint)`, 1/s.
    fn rate_per_s(&self, inertia_kg_m2: &dyn Fn(usize) -> f64) -> f64 {
        let _ = inertia_kg_m2;
        0.0
    }
}

/// A torque on the links, from outside or from something mounted in parallel to a gear.
pub trait LinkTorque: Debug + Send + Sync {
    /// Adds the torque that acts on the joints, Nm, N entries.
    fn add(&mut self, at: &Instant<'_>, acting_nm: &mut [f64]);
}

/// An addition to the dry friction of a joint.
pub trait DryTerm: Debug + Send + Sync {
    /// Addition to the level of dry friction for motion in `direction` (1 or −1), Nm.
    fn level_nm(&self, joint: usize, at: &Instant<'_>, direction: f64) -> f64;
}

/// Speed-dependent friction of a joint.
pub trait ViscousLaw: Debug + Send + Sync {
    /// The torque that opposes the velocity, Nm.
    fn torque_nm(&self, velocity_rad_s: f64) -> f64;

    /// The largest slope of the law, Nm s/rad.
    fn steepest_nm_s(&self) -> f64;
}

/// F_v q̇.
#[derive(Debug, Clone, Copy)]
pub struct LinearViscous(pub f64);

impl ViscousLaw for LinearViscous {
    fn torque_nm(&self, velocity_rad_s: f64) -> f64 {
        self.0 * velocity_rad_s
    }

    fn steepest_nm_s(&self) -> f64 {
        self.0.abs()
    }
}

/// The way of a shaft since the last completed step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// How far it has moved, rad.
    pub moved_rad: f64,
    /// How long that took, s.
    pub elapsed_s: f64,
    /// Its velocity at the end, rad/s.
    pub velocity_rad_s: f64,
    /// The level of dry friction at the end, Nm.
    pub level_nm: f64,
}

/// Dry friction with memory in the place of the jump at zero velocity: a torque that follows the path.
pub trait Bristle: Debug + Send + Sync {
    /// Number of state variables; they start at 0.
    fn state_len(&self) -> usize;

    /// Two torques that oppose the motion at the end of `way`, which began in `state`: the dry friction, at
    /// most about its level, and what acts beside it, Nm.
    fn torque_nm(&self, state: &[f64], way: Stretch) -> [f64; 2];

    /// Moves `state` to the end of `way`.
    fn advance(&self, state: &mut [f64], way: Stretch);

    /// The steepest slope of the torque against the path, for a level of `level_nm`, Nm/rad.
    fn stiffness_nm_rad(&self, level_nm: f64) -> f64;

    /// Torque per velocity beside the dry friction, Nm s/rad.
    fn damping_nm_s(&self) -> f64 {
        0.0
    }
}

/// What lies between a motor and its link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Gear {
    /// Nothing gives way.
    Rigid,
    /// A spring and a damper in parallel, with play of ± `half_gap_rad` in which they are not engaged.
    Compliant {
        stiffness_nm_rad: f64,
        /// Nm s/rad.
        damping_nm_s: f64,
        /// Half the play, rad; 0 for a gear without.
        half_gap_rad: f64,
    },
}

impl Gear {
    /// The transmitted torque in Nm for the twist θ − q and its rate.
    pub(crate) fn torque_nm(self, twist_rad: f64, twist_rad_s: f64) -> f64 {
        match self {
            Self::Rigid => 0.0,
            Self::Compliant { stiffness_nm_rad, damping_nm_s, half_gap_rad } => {
                let pressed = twist_rad - twist_rad.clamp(-half_gap_rad, half_gap_rad);
                if half_gap_rad > 0.0 && pressed == 0.0 {
                    return 0.0;
                }
                let torque = stiffness_nm_rad * pressed + damping_nm_s * twist_rad_s;
                // Flanks push; they do not pull when they part.
                if half_gap_rad > 0.0 && torque * pressed < 0.0 { 0.0 } else { torque }
            }
        }
    }
}

/// The physics in one joint's drive.
#[derive(Debug)]
pub struct JointPhysics {
    /// Level of dry friction in the positive and in the negative direction, Nm.
    pub coulomb_nm: [f64; 2],
    /// Additions to it.
    pub dry_terms: Vec<Box<dyn DryTerm>>,
    /// Speed-dependent friction.
    pub viscous: Box<dyn ViscousLaw>,
    /// Dry friction per transmitted torque while the motor drives the load, and while the load drives.
    pub load_coefficient: [f64; 2],
    /// Memory in the place of the jump at zero velocity.
    pub bristle: Option<Box<dyn Bristle>>,
    /// What lies between motor and link.
    pub gear: Gear,
    /// Friction that warms up.
    pub warmth: Option<Warmth>,
}

/// A rotor that turns with a combination of shaft velocities, Σ ratio_j q̇_j, with inertia and friction of its
/// own; each of the shafts feels its ratio's share of the torque (virtual power).
#[derive(Debug, Clone, PartialEq)]
pub struct CoupledRotor {
    /// (joint, ratio) pairs.
    pub ratios: Vec<(usize, f64)>,
    pub inertia_kg_m2: f64,
    /// Viscous friction, Nm s/rad.
    pub viscous_nm_s: f64,
    /// Coulomb friction, Nm.
    pub coulomb_nm: f64,
}

/// The machine: a robot with everything that acts in it.
#[derive(Debug)]
pub struct Machine {
    /// The robot as it is; effects change its bodies, gravity or rotors.
    pub robot: Robot,
    /// The robot as its controller believes it to be.
    pub nominal: Robot,
    pub joints: Vec<JointPhysics>,
    /// Rotors that turn with several joints.
    pub couplings: Vec<CoupledRotor>,
    pub shaft_torques: Vec<Box<dyn ShaftTorque>>,
    pub link_torques: Vec<Box<dyn LinkTorque>>,
}

impl Machine {
    /// The robot as it stands: Coulomb, viscous and load-dependent friction, rigid gears.
    pub fn new(robot: &Robot) -> Self {
        let joints = robot
            .drives
            .iter()
            .map(|drive| JointPhysics {
                coulomb_nm: [drive.coulomb_nm; 2],
                dry_terms: Vec::new(),
                viscous: Box::new(LinearViscous(drive.viscous_nm_s)),
                load_coefficient: [drive.load_coefficient; 2],
                bristle: None,
                gear: Gear::Rigid,
                warmth: None,
            })
            .collect();
        Self {
            robot: robot.clone(),
            nominal: robot.clone(),
            joints,
            couplings: Vec::new(),
            shaft_torques: Vec::new(),
            link_torques: Vec::new(),
        }
    }
}

impl JointPhysics {
    /// The level of dry friction at this instant for motion in `direction`, Nm; never negative.
    pub(crate) fn level_nm(&self, joint: usize, at: &Instant<'_>, direction: f64) -> f64 {
        let base = self.coulomb_nm[usize::from(direction < 0.0)];
        let added: f64 = self.dry_terms.iter().map(|term| term.level_nm(joint, at, direction)).sum();
        (base + added).max(0.0)
    }

    /// Whether there is dry friction that jumps with the direction of motion.
    pub(crate) fn jumps(&self) -> bool {
        self.bristle.is_none()
            && (self.coulomb_nm != [0.0; 2]
                || !self.dry_terms.is_empty()
                || self.load_coefficient != [0.0; 2])
    }

    /// Dry friction per transmitted torque for motion in `direction` under a load of the given sign: the
    /// motor drives the load if both agree.
    pub(crate) fn load_coefficient(&self, direction: f64, load_sign: f64) -> f64 {
        self.load_coefficient[usize::from(direction * load_sign < 0.0)]
    }
}
