//! The list of the unknown effects, and the kinds of both lists.

use aurt_simulation::{
    SimulationError,
    effects::{Effect, EffectKind, catalogue, kind_among},
};
use serde_json::Value;

use super::{
    acceleration_friction::AccelerationFriction, cable_drag::CableDrag, cross_drag::CrossDrag,
    leaking_spring::LeakingSpring, periodic_disturbance::PeriodicDisturbance,
    position_damper::PositionDamper, sticking_window::StickingWindow,
};

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
