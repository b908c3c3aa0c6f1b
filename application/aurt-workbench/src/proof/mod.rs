//! Proofs: concealed cases of several worlds, diagnosed by processes that see nothing but a case's folder, and scored.
//!
//! `place` says where things lie, `source` and its worlds make cases, `diagnosed` runs a case, `shard` divides and
//! collects, `scores` compares with the truth, `report` writes the tables, `learn` what confidence is made of.

mod diagnosed;
mod injected;
mod learn;
mod mujoco;
mod place;
mod plans;
mod report;
mod scores;
mod shard;
mod simulated;
mod source;

pub use diagnosed::{Options, prove};
pub use learn::learn;
pub use place::{Place, Proof};
pub use plans::small;
pub use report::{Proven, report};
pub use scores::{Verdicts, read_scores};
pub use shard::{Shard, collect};
pub use source::{Ingredients, Source, source};

/// The verdict of a diagnosis.
pub const VERDICT: &str = "verdict.json";
/// What simpler methods would have said, beside it.
pub const COMPARISON: &str = "comparison.json";
/// Why a diagnosis gave no verdict, in its place.
pub const FAILED: &str = "failed.txt";
