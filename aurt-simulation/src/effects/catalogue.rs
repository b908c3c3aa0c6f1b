//! The list of all effects.

use aurt_files::suggestion::likely;
use serde_json::Value;

use super::{CATALOGUE, Effect, EffectKind};
use crate::error::SimulationError;

/// All effects of the vocabulary, by identifier.
pub const fn catalogue() -> &'static [EffectKind] {
    CATALOGUE
}

/// The kind of an identifier.
pub fn kind(identifier: &str) -> Result<&'static EffectKind, SimulationError> {
    kind_among(CATALOGUE.iter(), identifier)
}

/// The kind of an identifier among others than the catalogue's.
pub fn kind_among(
    kinds: impl Iterator<Item = &'static EffectKind> + Clone,
    identifier: &str,
) -> Result<&'static EffectKind, SimulationError> {
    kinds.clone().find(|kind| kind.identifier == identifier).ok_or_else(|| SimulationError::UnknownEffect {
        name: identifier.into(),
        meant: likely(identifier, kinds.clone().map(|kind| kind.identifier)).map(Into::into),
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
