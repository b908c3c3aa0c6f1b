//! Sweeps: many variants of an experiment, each fitted and judged on recordings that it was not fitted to.
//!
//! `[sweep]` in an experiment names keys and the values to try: a grid, lists that step together, named variants.
//! [`Sweep::read`] resolves them to [`Point`]s, one experiment each, and refuses keys that no experiment has.
//! [`Plan::of`] gives every point a key, a hash of all that its result depends on. [`run`] evaluates the points whose
//! result is not in the [`Folder`] yet, on all cores, and keeps each as soon as it is there; [`run_point`] does one of
//! them, for job arrays ([`slurm`]). [`Ranking`] compares what there is.
//!
//! Points that differ in nothing but friction share the rows of their rigid bodies
//! ([`RigidRows`](aurt_calibration::RigidRows)), which are evaluated and filtered once.

mod comparison;
mod definition;
mod documents;
mod error;
mod evaluation;
mod family;
mod folder;
mod identity;
mod loading;
mod place;
mod plan;
mod points;
mod ranking;
mod result;
mod run;
pub mod slurm;

pub use comparison::{holm, paired, paired_overall};
pub use definition::{Definition, Setting, Step, Validate};
pub use error::{PointError, SweepError};
pub use folder::Folder;
pub use identity::code_is_in;
pub use loading::{Data, Settings};
pub use place::Place;
pub use plan::{Plan, PlannedPoint};
pub use points::{Point, Sweep};
pub use ranking::{Failed, JointRank, LEVEL, Ranked, Ranking};
pub use result::{Evaluation, Fold, JointErrors, Judged, Outcome, PointResult, Rows};
pub use run::{Event, Summary, run, run_point};
