//! Every registered model against what it says of itself. A new model is tested by being registered.

#![expect(clippy::unwrap_used, reason = "a test whose model does not work has failed")]

mod invariants;
mod listing;
mod models;
mod planar_arm;
mod recovery;
