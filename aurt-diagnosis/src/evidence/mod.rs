//! Second moments of all columns in blocks of time: nested fits, cross-validation, and what can be decided at all.

pub(crate) mod account;
pub mod baseline;
pub(crate) mod between;
pub mod chance;
pub(crate) mod decidable;
pub(crate) mod deviations;
pub(crate) mod given;
pub(crate) mod gram;
pub(crate) mod judge;
pub(crate) mod judged;
pub(crate) mod linear;
pub(crate) mod nested;
pub(crate) mod null;
pub(crate) mod problem;
pub(crate) mod refit;
pub(crate) mod residuals;
pub(crate) mod total;

pub use baseline::Baseline;
pub use chance::Chance;
pub use problem::Problem;
