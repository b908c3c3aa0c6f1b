//! The list of the unknown effects, and the kinds of both lists.

use aurt_simulation::SimulationError;
use aurt_simulation::effects::{Effect, EffectKind, catalogue, kind_among};
use serde_json::Value;

use super::acceleration_friction::AccelerationFriction;
use super::cable_drag::CableDrag;
use super::cross_drag::CrossDrag;
use super::leaking_spring::LeakingSpring;
use super::periodic_disturbance::PeriodicDisturbance;
use super::position_damper::PositionDamper;
use super::sticking_window::StickingWindow;

const UNKNOWN: &[EffectKind] = &[
    EffectKind::of::<AccelerationFriction>(),
    EffectKind::of::<CableDrag>(),
    EffectKind::of::<CrossDrag>(),
    EffectKind::of::<LeakingSpring>(),
    EffectKind::of::<PeriodicDisturbance>(),
    EffectKind::of::<PositionDamper>(),
    EffectKind::of::<StickingWindow>(),
];

/// Effects outside the vocabulary, by identifier.
pub const fn unknown_effects() -> &'static [EffectKind] {
    UNKNOWN
}

pub fn all_kinds() -> impl Iterator<Item = &'static EffectKind> + Clone {
    catalogue().iter().chain(UNKNOWN)
}

/// The kind of an identifier, from either list.
pub fn kind(identifier: &str) -> Result<&'static EffectKind, SimulationError> {
    kind_among(all_kinds(), identifier)
}

/// The effect of an identifier with the given fields.
pub fn read_effect(identifier: &str, fields: Value) -> Result<Box<dyn Effect>, SimulationError> {
    kind(identifier)?.effect(fields)
}
