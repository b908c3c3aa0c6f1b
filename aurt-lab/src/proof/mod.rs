//! Proofs: concealed cases of several worlds, diagnosed by processes that see nothing but a case's folder, and scored.
//!
//! `place` says where things lie, the sources of `worlds` make cases, `diagnosed` runs a case, `variants` writes it
//! differently, `shard` divides and collects, `scores` compares with the truth, `report` writes the tables, `learn` what confidence is made of, `program` is what diagnoses.

mod diagnosed;
mod injected;
mod learn;
mod mujoco;
mod place;
mod plans;
mod program;
mod report;
mod scores;
mod shard;
mod simulated;
mod source;
mod variants;
mod worlds;

pub use diagnosed::{Options, prove};
pub use learn::learn;
pub use place::{Place, Proof};
pub use plans::small;
pub use program::program;
pub use report::{Proven, report};
pub use scores::{Verdicts, add_oracle, read_scores};
pub use shard::{Shard, collect};
pub use source::{Ingredients, Source};
pub use worlds::source;

pub const VERDICT: &str = "verdict.json";
/// Why a diagnosis gave no verdict, in its place.
pub const FAILED: &str = "failed.txt";
/// Why a case does not have a variant, in the place of its verdict.
pub const UNFIT: &str = "unfit.txt";
