//! What is known of all effects of one identifier.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::effect::Effect;
use crate::error::SimulationError;
use crate::random::Random;
use crate::robots::{Drive, Robot, Rotors};

/// Families of effects.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Family {
    /// Dry friction.
    F,
    /// Viscous friction.
    V,
    /// Memory.
    H,
    /// Load.
    L,
    /// Inertia and gravity.
    I,
    P,
    /// Drive and instrument.
    D,
    /// Coupling.
    C,
    /// External.
    X,
    /// Quality of the data.
    Q,
}

/// In which recordings an effect can be so that a diagnosis has something to find.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Presence {
    /// In all: the experiment's structure lacks it.
    Structural,
    /// In the later ones: something has changed since calibration.
    Later,
    Either,
}

/// Where the shapes of laws (exponents, velocities, ratios, orders, time constants) are drawn from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Shapes {
    /// The values that machines usually have.
    #[default]
    Usual,
    /// A continuum in which no value stands out.
    Continuum,
}

/// What an effect is drawn for.
#[derive(Debug, Clone, Copy)]
pub struct Draw<'a> {
    pub robot: &'a Robot,
    /// The joints that [`EffectKind::choose_joints`] chose.
    pub joints: &'a [usize],
    /// Largest torque of each joint's motions, Nm.
    pub peak_torque_nm: &'a [f64],
    /// Duration of the shortest recording, s.
    pub duration_s: f64,
    pub shapes: Shapes,
}

impl Draw<'_> {
    /// One value per chosen joint: `per_noise` times the noise of its measured torque.
    pub fn noises(&self, per_noise: f64) -> Vec<f64> {
        self.joints.iter().map(|j| per_noise * self.robot.drives[*j].torque_noise_nm).collect()
    }

    pub fn continuous(&self) -> bool {
        self.shapes == Shapes::Continuum
    }

    /// The first chosen joint, and its drive.
    pub fn drive(&self) -> (usize, &Drive) {
        let joint = self.joints.first().copied().unwrap_or(0);
        (joint, &self.robot.drives[joint])
    }
}

/// How many joints an effect takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Takes {
    /// One or, more rarely, two.
    Few,
    One,
    /// A joint and another.
    Pair,
    All,
}

/// What is known of all effects of one identifier.
#[derive(Debug, Clone, Copy)]
pub struct EffectKind {
    /// Identifier, snake_case.
    pub identifier: &'static str,
    pub family: Family,
    pub presence: Presence,
    /// Where the rotors' inertia has to be, if that matters.
    pub rotors: Option<Rotors>,
    pub takes: Takes,
    /// Whether it can be on a joint.
    pub suits: fn(&Robot, usize) -> bool,
    pub draw: fn(&Draw<'_>, &mut Random) -> Box<dyn Effect>,
    /// Reads the fields of an effect.
    pub read: fn(Value) -> Result<Box<dyn Effect>, serde_json::Error>,
}

impl EffectKind {
    /// Joints for an effect of this kind.
    pub fn choose_joints(&self, robot: &Robot, random: &mut Random) -> Vec<usize> {
        let joints = robot.joints();
        let mut all: Vec<usize> = (0..joints).filter(|j| (self.suits)(robot, *j)).collect();
        random.shuffle(&mut all);
        let count = match self.takes {
            Takes::All => {
                all.sort_unstable();
                joints
            }
            Takes::One => 1,
            Takes::Pair => 2,
            Takes::Few => 1 + usize::from(random.chance(0.3)),
        };
        all.truncate(count);
        if self.takes == Takes::Few {
            all.sort_unstable();
        }
        all
    }

    /// Whether the robot has joints for an effect of this kind.
    pub fn fits(&self, robot: &Robot) -> bool {
        let suited = (0..robot.joints()).filter(|j| (self.suits)(robot, *j)).count();
        match self.takes {
            Takes::Pair => suited >= 2,
            Takes::Few | Takes::One | Takes::All => suited >= 1,
        }
    }

    /// An effect of this kind, of medium strength as far as that can be said beforehand.
    pub fn draw(&self, context: &Draw<'_>, random: &mut Random) -> Box<dyn Effect> {
        (self.draw)(context, random)
    }

    /// The effect of this kind with the given fields.
    ///
    /// # Errors
    /// [`SimulationError::Unreadable`]: what is wrong with the fields.
    pub fn effect(&self, fields: Value) -> Result<Box<dyn Effect>, SimulationError> {
        (self.read)(fields).map_err(|error| {
            SimulationError::unreadable(format!("effect `{}`", self.identifier), error.to_string())
        })
    }

    /// Whether the effect has a size of its own on each of its joints.
    pub fn joint_by_joint(&self) -> bool {
        self.takes == Takes::Few
    }

    /// Whether the effect concerns all joints at once.
    pub fn whole_arm(&self) -> bool {
        self.takes == Takes::All
    }
}

/// Whether a joint's friction does not depend on the load by itself.
pub fn constant_level(robot: &Robot, joint: usize) -> bool {
    robot.drives[joint].load_coefficient == 0.0
}
