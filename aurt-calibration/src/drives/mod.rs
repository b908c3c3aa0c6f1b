//! Arms with drives on their joints, and the output error of their closed loops.
//!
//! - [`DrivenArm`] puts drives ([`DriveModel`](aurt_traits::DriveModel)) on the joints of a chain or tree, with dry friction, rotors, stops and a floor; [`DrivenArm::rollout`]
//!   simulates the closed loop from commands alone.
//! - [`output_error`] estimates its numbers from commands and positions.
//!
//! Everything is computed in [`Jet`](aurt_traits::Jet)s: one code gives a simulation and its derivatives, of the
//! branch of dry friction that is taken, with the speed in the Stribeck factor and in the floor's friction held.

mod absorbed;
mod arm;
mod bodies;
mod columns;
mod determined;
mod deviations;
mod error;
mod output_error;
mod plant;
mod rollout;

pub use absorbed::{Absorbed, absorbed};
pub use arm::{DrivenArm, DrivenJoint, Floor, Mechanics};
pub use columns::{Selection, stem};
pub use determined::Undetermined;
pub use error::DriveError;
pub use output_error::{
    EstimatedNumber, Options, OutputErrorFit, loss, output_error, output_error_from, slopes,
};
pub use rollout::{DriveRecording, LONGEST_STEP_S};
