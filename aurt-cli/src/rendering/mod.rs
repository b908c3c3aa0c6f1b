//! What people and programs see of results and failures.

pub mod excerpt;
pub mod problem;
pub mod progress;
pub mod terminal;
