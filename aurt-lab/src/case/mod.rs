//! Cases: folders with an experiment and recordings, whose physics is known and sealed elsewhere.

mod conceal;
mod experiment;
mod laboratory;
mod layout;
mod make;
mod plan;
mod probe;
mod request;
mod rough;
pub(crate) mod servo;
mod truth;
mod world;

pub(crate) use layout::planned;
pub use layout::{RecordingSettings, Role};
pub use make::{Case, make_case};
pub use plan::{NullPlan, PairPlan, Plan, SinglePlan};
pub use request::{CaseRequest, CaseType};
pub use truth::{TrueEffect, Truth, ValidationFloor};
pub use world::World;
