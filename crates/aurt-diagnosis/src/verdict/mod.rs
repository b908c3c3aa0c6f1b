//! What may be said of what was found.

pub(crate) mod answer;
pub(crate) mod confidence;
pub(crate) mod findings;
pub(crate) mod localise;
mod model;
pub(crate) mod registered;
mod series;
pub(crate) mod transmission;
mod write;

pub use confidence::Learnt;
pub use model::{
    Alternative, Answer, Evidence, Finding, HeldOut, JointResidual, NotDecidable, RegisteredFinding, Shift,
    Verdict,
};
pub use series::{JointSeriesRows, RecordingSeries, series};
pub use write::verdict as write_verdict;
