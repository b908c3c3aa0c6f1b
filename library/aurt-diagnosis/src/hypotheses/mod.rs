//! The physics that can be missing: one effect a file, and registered friction models.

pub mod candidates;
pub mod effects;
pub mod group;
pub(crate) mod periodogram;
pub mod registered;
pub mod shape;

pub use candidates::Candidate;
pub use group::{Group, Switch};
pub use registered::RegisteredModel;
