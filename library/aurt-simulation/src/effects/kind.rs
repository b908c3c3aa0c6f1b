use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::Effect;
use crate::random::Random;
use crate::{Robot, Rotors, SimulationError};

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
    /// Position.
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
    /// Either.
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
    /// The robot.
    pub robot: &'a Robot,
    /// The joints that [`EffectKind::choose_joints`] chose.
    pub joints: &'a [usize],
    /// Largest torque of each joint's motions, Nm.
    pub peak_torque_nm: &'a [f64],
    /// Duration of the shortest recording, s.
    pub duration_s: f64,
    /// Where shapes are drawn from.
    pub shapes: Shapes,
}

impl Draw<'_> {
    /// One value per chosen joint: `per_noise` times the noise of its measured torque.
    pub(super) fn noises(&self, per_noise: f64) -> Vec<f64> {
        self.joints.iter().map(|j| per_noise * self.robot.drives[*j].torque_noise_nm).collect()
    }

    /// Whether shapes are drawn from a continuum.
    pub(super) fn continuous(&self) -> bool {
        self.shapes == Shapes::Continuum
    }

    /// The first chosen joint.
    pub(super) fn joint(&self) -> usize {
        self.joints.first().copied().unwrap_or(0)
    }
}

/// How many joints an effect takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Takes {
    /// One or, more rarely, two.
    Few,
    /// One.
    One,
    /// A joint and another.
    Pair,
    /// All.
    All,
}

/// What is known of all effects of one identifier.
#[derive(Debug, Clone, Copy)]
pub struct EffectKind {
    /// Identifier, snake_case.
    pub identifier: &'static str,
    /// Family.
    pub family: Family,
    /// One line.
    pub summary: &'static str,
    /// In which recordings it can be.
    pub presence: Presence,
    /// Where the rotors' inertia has to be, if that matters.
    pub rotors: Option<Rotors>,
    pub(super) takes: Takes,
    pub(super) suits: fn(&Robot, usize) -> bool,
    pub(super) draw: fn(&Draw<'_>, &mut Random) -> Box<dyn Effect>,
    pub(super) read: fn(Value) -> Result<Box<dyn Effect>, serde_json::Error>,
}

impl EffectKind {
    /// Joints for an effect of this kind.
    #[must_use]
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
    #[must_use]
    pub fn fits(&self, robot: &Robot) -> bool {
        let suited = (0..robot.joints()).filter(|j| (self.suits)(robot, *j)).count();
        match self.takes {
            Takes::Pair => suited >= 2,
            Takes::Few | Takes::One | Takes::All => suited >= 1,
        }
    }

    /// An effect of this kind, of medium strength as far as that can be said beforehand.
    #[must_use]
    pub fn draw(&self, context: &Draw<'_>, random: &mut Random) -> Box<dyn Effect> {
        (self.draw)(context, random)
    }

    /// Whether the effect has a size of its own on each of its joints.
    pub(crate) fn joint_by_joint(&self) -> bool {
        self.takes == Takes::Few
    }

    /// Whether the effect concerns all joints at once.
    #[must_use]
    pub fn whole_arm(&self) -> bool {
        self.takes == Takes::All
    }
}

/// Any joint will do.
pub(super) fn any_joint(_robot: &Robot, _joint: usize) -> bool {
    true
}

/// Reads the fields of an effect type.
pub(super) fn read<E: Effect + for<'d> Deserialize<'d> + 'static>(
    fields: Value,
) -> Result<Box<dyn Effect>, serde_json::Error> {
    Ok(Box::new(serde_json::from_value::<E>(fields)?))
}

const CATALOGUE: &[EffectKind] = &[
    super::backlash::KIND,
    super::base_tilt::KIND,
    super::coulomb::KIND,
    super::coulomb_asymmetry::KIND,
    super::current_offset::KIND,
    super::drive_efficiency::KIND,
    super::dropped_samples::KIND,
    super::external_contact::KIND,
    super::friction_level_changed::KIND,
    super::joint_coupling_friction::KIND,
    super::joint_elasticity::KIND,
    super::load_dependent_friction::KIND,
    super::payload::KIND,
    super::presliding_hysteresis::KIND,
    super::rotor_inertia::KIND,
    super::saturation::KIND,
    super::spring::KIND,
    super::stribeck::KIND,
    super::temperature_dependent_friction::KIND,
    super::time_delay::KIND,
    super::torque_constant::KIND,
    super::torque_ripple::KIND,
    super::viscous::KIND,
    super::viscous_asymmetry::KIND,
    super::viscous_nonlinear::KIND,
];

/// All effects of the vocabulary, by identifier.
#[must_use]
pub const fn catalogue() -> &'static [EffectKind] {
    CATALOGUE
}

/// Effects outside the vocabulary, by identifier.
#[must_use]
pub const fn strangers() -> &'static [EffectKind] {
    super::stranger::KINDS
}

/// The kind of an identifier, from either list.
///
/// # Errors
/// [`SimulationError::UnknownEffect`].
pub fn kind(identifier: &str) -> Result<&'static EffectKind, SimulationError> {
    let all = || CATALOGUE.iter().chain(super::stranger::KINDS);
    all().find(|kind| kind.identifier == identifier).ok_or_else(|| SimulationError::UnknownEffect {
        name: identifier.into(),
        meant: all()
            .map(|kind| (edit_distance(kind.identifier, identifier), kind.identifier))
            .min()
            .filter(|(distance, _)| *distance <= 3)
            .map(|(_, name)| name.into()),
        known: all().map(|kind| kind.identifier.into()).collect(),
    })
}

/// The effect of an identifier with the given fields.
///
/// # Errors
/// [`SimulationError::UnknownEffect`], or what is wrong with the fields.
pub fn read_effect(identifier: &str, fields: Value) -> Result<Box<dyn Effect>, SimulationError> {
    let kind = kind(identifier)?;
    (kind.read)(fields).map_err(|error| SimulationError::Unreadable {
        path: format!("effect `{identifier}`").into(),
        reason: error.to_string(),
    })
}

/// Number of insertions, deletions and replacements between two words.
fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], i + 1);
        for (j, y) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(x != *y);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}
