//! What people and programs see of results and failures.

pub mod excerpt;
pub mod json;
pub mod number;
pub mod problem;
pub mod table;
pub mod terminal;
pub mod text;
