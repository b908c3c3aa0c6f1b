use serde::{Deserialize, Serialize};

use crate::effects::kind;
use crate::strength::Strength;
use aurt_simulation::effects::{EffectKind, Presence};
use aurt_simulation::robots::{Robot, Rotors};
use aurt_simulation::{Random, SimulationError};

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CaseType {
    Null,
    Single,
    /// Two effects of the vocabulary.
    Pair,
    #[serde(alias = "stranger")]
    UnknownEffect,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CaseRequest {
    pub robot: String,
    pub case_type: CaseType,
    pub effects: Vec<String>,
    pub strength: Strength,
}

impl CaseRequest {
    pub fn kinds(&self) -> Result<Vec<&'static EffectKind>, SimulationError> {
        self.effects.iter().map(|name| kind(name)).collect()
    }

    /// Where the rotors' inertia is: where the effects need it, else by chance.
    pub(super) fn rotors(kinds: &[&EffectKind], random: &mut Random) -> Rotors {
        let chance = if random.chance(0.5) { Rotors::Geared } else { Rotors::InLinks };
        kinds.iter().find_map(|kind| kind.rotors).unwrap_or(chance)
    }

    /// Whether the effects are in the later recordings alone: where they can only be, else by chance.
    pub(super) fn later(kinds: &[&EffectKind], random: &mut Random) -> bool {
        let chance = random.chance(0.5);
        kinds
            .iter()
            .find_map(|kind| match kind.presence {
                Presence::Structural => Some(false),
                Presence::Later => Some(true),
                Presence::Either => None,
            })
            .unwrap_or(chance)
    }

    pub fn is_possible(robot: &Robot, kinds: &[&EffectKind]) -> bool {
        let rotors: Vec<Rotors> = kinds.iter().filter_map(|k| k.rotors).collect();
        let present: Vec<Presence> =
            kinds.iter().map(|k| k.presence).filter(|p| *p != Presence::Either).collect();
        let agree = rotors.windows(2).all(|w| w[0] == w[1]) && present.windows(2).all(|w| w[0] == w[1]);
        let built = robot.clone().with_rotors(rotors.first().copied().unwrap_or(Rotors::Geared));
        agree && kinds.iter().all(|kind| kind.fits(&built))
    }
}
