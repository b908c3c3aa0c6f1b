//! Locating the mismatch between a robot model and recordings, and naming the physics left out.
//!
//! Data flow: [`Question`] → [`investigate`] (baseline, candidates of all [`effects`], selection by
//! cross-validation over blocks of time) → [`Verdict`].

mod answer;
mod baseline;
mod candidates;
mod comparison;
mod confidence;
mod contact;
mod diagnose;
pub mod effects;
mod error;
mod faults;
mod findings;
mod floor;
mod gram;
mod improve;
mod instrument_filter;
mod judged;
mod late;
mod linear;
mod localise;
mod partition;
mod paths;
mod periodogram;
mod problem;
mod question;
mod registered;
mod report;
mod residuals;
mod rows;
mod selection;
mod series;
mod simulated;
mod verdict;
mod wideband;

pub use baseline::Baseline;
pub use candidates::Candidate;
pub use comparison::{Method, MethodFinding, MethodVerdict};
pub use contact::{Contact, ContactOptions, ContactRows, ForceColumns, find_contacts, force_columns};
pub use diagnose::{Investigation, investigate};
pub use error::DiagnosisError;
pub use faults::{Fault, RecordingFaults};
pub use improve::{Improvement, improved_experiment, improvement};
pub use late::{Delay, Late};
pub use partition::Partition;
pub use paths::{from_folder, with_file_names};
pub use problem::{Problem, Switch};
pub use question::{Question, QuestionedRecording, Spoilt};
pub use registered::RegisteredModel;
pub use report::verdict as write_verdict;
pub use rows::{Fit, Instrument, Layout, RecordingRows, Role};
pub use selection::{Chosen, Group, Selection, SelectionOptions};
pub use series::{JointSeriesRows, RecordingSeries, series};
pub use verdict::{
    Alternative, Answer, Evidence, Finding, HeldOut, JointResidual, NotDecidable, RegisteredFinding, Shift,
    Verdict,
};
pub use wideband::{FullRate, InertiaColumns, Shaking, find_shaking};
