//! Scoring: what a diagnosis said of concealed cases, compared with the truth.
//!
//! It reads `verdict.json` as anybody could and shares no code with what wrote it. What counts as right:
//!
//! | case | right if |
//! |---|---|
//! | single | the verdict names an effect (`named`; `partly_explained` in worlds with a background), the effect is first, or one of its declared alternatives, on exactly its joints (whole-arm effects have none of their own), in the right kinds of recordings, and nothing else is claimed |
//! | pair | the same of both, as the first two |
//! | null | `no_mismatch`, or no claim but the background's and the reference's (beside a background the structure may be `unexplained`); of real recordings: no change |
//! | unknown effect | `unexplained` or `partly_explained` |
//! | single whose candidate was removed | `unexplained` or `partly_explained`, or a neighbour ([`neighbours`]) first under a verdict that names an effect |
//!
//! Every part is counted for itself as well. What the experiment does not declare besides the effects (`background`), and
//! what is claimed of the same recordings without the effects (the reference), or of structure by any reference of the robot, is
//! neither right nor wrong. Effects that no recording tells apart (`coulomb_asymmetry` and `current_offset`) are counted strictly, and as one class.

mod board;
mod case_score;
mod claim;
mod claim_set;
mod compared;
mod invariance;
mod isotonic;
mod leak;
mod learnt;
mod neighbours;
mod news;
mod nulls;
mod parameters;
mod reliability;
mod share;
mod table;
#[cfg(test)]
mod tests;
mod world_board;

pub use board::Scoreboard;
pub use case_score::{CaseScore, ScoredFinding, score};
pub use claim::{Answer, Claim, ClaimedAlternative, ClaimedEffect, ClaimedValue};
pub use claim_set::{ClaimDifference, ClaimSet};
pub use invariance::{HALVES, Invariance, VariantDifference};
pub use leak::leaks;
pub use learnt::learnt;
pub use neighbours::neighbours;
pub use parameters::ParameterError;
pub use reliability::{Bin, Reliability};
pub use share::Share;
pub use world_board::{Confusion, EffectRow, Singles, WorldBoard};
