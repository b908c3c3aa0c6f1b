//! What may be said of what was found.

pub(crate) mod answer;
pub(crate) mod confidence;
pub(crate) mod contacts;
mod errors;
pub(crate) mod faults;
pub(crate) mod findings;
mod finite;
mod held_out;
pub(crate) mod localise;
mod memory;
mod model;
mod not_examined;
pub(crate) mod registered;
pub(crate) mod sentence;
mod series;
pub(crate) mod transmission;
mod write;

pub use confidence::{Curves, LEARNT_SCHEMA, Learnt, LearntFrom, Rate, SCORE, interpolated};
pub(crate) use findings::{open_rivals, reported};
pub use model::{
    Alternative, Answer, Evidence, Finding, HeldOut, HeldOutDifference, Indication, JointResidual,
    NotDecidable, NotExamined, RegisteredFinding, SCHEMA, Shift, Verdict,
};
pub use series::{JointSeriesRows, RecordingSeries, series};
pub(crate) use write::share_left;
pub use write::verdict as write_verdict;
