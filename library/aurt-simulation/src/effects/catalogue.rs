//! The list of all effects.

use serde_json::Value;

use super::effect::Effect;
use super::kind::EffectKind;
use crate::error::SimulationError;

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

/// The kind of an identifier.
///
/// # Errors
/// [`SimulationError::UnknownEffect`].
pub fn kind(identifier: &str) -> Result<&'static EffectKind, SimulationError> {
    kind_among(CATALOGUE.iter(), identifier)
}

/// The kind of an identifier among others than the catalogue's.
///
/// # Errors
/// [`SimulationError::UnknownEffect`].
pub fn kind_among(
    kinds: impl Iterator<Item = &'static EffectKind> + Clone,
    identifier: &str,
) -> Result<&'static EffectKind, SimulationError> {
    kinds.clone().find(|kind| kind.identifier == identifier).ok_or_else(|| SimulationError::UnknownEffect {
        name: identifier.into(),
        meant: kinds
            .clone()
            .map(|kind| (edit_distance(kind.identifier, identifier), kind.identifier))
            .min()
            .filter(|(distance, _)| *distance <= 3)
            .map(|(_, name)| name.into()),
        known: kinds.map(|kind| kind.identifier.into()).collect(),
    })
}

/// The effect of an identifier with the given fields.
///
/// # Errors
/// [`SimulationError::UnknownEffect`], or what is wrong with the fields.
pub fn read_effect(identifier: &str, fields: Value) -> Result<Box<dyn Effect>, SimulationError> {
    kind(identifier)?.effect(fields)
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
