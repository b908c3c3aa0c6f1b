//! What commands found, as pages: `report.html`, and with `--plots` every figure as a file of its own.
//!
//! Pages are made from the structures that metrics.json and verdict.json are made from, and carry these documents.

pub mod calibration;
pub mod diagnosis;
mod essential;
pub mod figures;
pub mod parts;

pub const FILE: &str = "report.html";
