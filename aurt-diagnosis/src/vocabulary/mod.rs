//! What an effect consists of: its descriptor, its parameters, and the terms that it proposes.

pub mod effect;
pub mod own_friction;
pub mod parameter;
pub(crate) mod periodogram;
pub mod proposal;
pub mod shape;

pub use effect::{Effect, Family, Kind, Means, Wording};
pub use own_friction::OwnFriction;
pub use parameter::{Parameter, Unit};
pub(crate) use proposal::AROUND;
pub use proposal::{Addition, Context, Presence, Proposal};
