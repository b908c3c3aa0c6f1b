//! Scoring: what a diagnosis said of concealed cases, compared with the truth.
//!
//! It reads `verdict.json` as anybody could and shares no code with what wrote it. What counts as right:
//!
//! | case | right if |
//! |---|---|
//! | null | the verdict is `no_mismatch` |
//! | single | the first effect is the true one; with alternatives: it or one of at most two alternatives is |
//! | pair | the first two different effects are the true ones |
//! | stranger | the verdict is `unexplained` |
//! | single whose candidate was removed | `unexplained`, or the first effect is a neighbour ([`neighbours`]) |

mod board;
mod case_score;
mod claim;
mod neighbours;
mod table;

pub use board::{Confusion, EffectRow, Reliability, Scoreboard, Share};
pub use case_score::{CaseScore, ParameterError, score};
pub use claim::{Answer, Claim, ClaimedEffect};
pub use neighbours::neighbours;
