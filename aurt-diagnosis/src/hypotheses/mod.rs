//! What effects propose, and registered friction models, as hypotheses over columns.

pub mod candidates;
pub mod group;
pub mod registered;

pub use candidates::Candidate;
pub use group::{Group, Switch};
pub use registered::RegisteredModel;
