//! Every registered model against what it says of itself. A new model is tested by being registered.

mod invariants;
mod listing;
mod models;
pub(crate) mod planar_arm;
mod recovery;
