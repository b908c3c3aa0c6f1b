//! Physics outside the vocabulary: a diagnosis that knows only the vocabulary has to say that something is
//! there that it does not know.

mod acceleration_friction;
mod cable_drag;
mod cross_drag;
mod leaking_spring;
mod periodic_disturbance;
mod position_damper;
mod sticking_window;

pub use acceleration_friction::AccelerationFriction;
pub use cable_drag::CableDrag;
pub use cross_drag::CrossDrag;
pub use leaking_spring::LeakingSpring;
pub use periodic_disturbance::PeriodicDisturbance;
pub use position_damper::PositionDamper;
pub use sticking_window::StickingWindow;

use super::EffectKind;

pub(super) const KINDS: &[EffectKind] = &[
    acceleration_friction::KIND,
    cable_drag::KIND,
    cross_drag::KIND,
    leaking_spring::KIND,
    periodic_disturbance::KIND,
    position_damper::KIND,
    sticking_window::KIND,
];
