//! Real recordings with an effect added.
//!
//! The background is a real robot's: its friction, its noise, its clock. The effect is known, because it is computed
//! from the measured positions and added to what the joints measured. Nothing here is shared with what diagnoses or
//! calibrates: positions are smoothed and differentiated by local polynomials ([`Smoothed`]), the robot's own model is a
//! small least squares ([`OwnModel`]), and laws are written again ([`Law`]).
//!
//! An injection changes the measurement alone. A real effect would also change the motion, by a little, through the
//! controller; with the motion given, the torque that the joints need is the same.

mod applied;
mod bodies;
mod columns;
mod describe;
mod drawing;
mod friction;
mod gram;
mod injection;
mod instrument;
mod kinds;
mod law;
mod outside;
mod own_model;
mod real;
mod resonator;
mod scene;
mod sizing;
mod smoothed;
mod split;

pub use applied::applied;
pub use columns::StructureColumns;
pub use describe::SizeName;
pub use gram::{Gram, mean_square};
pub use injection::{Injection, Recorded};
pub use kinds::{Kind, injectable, unknown_injectable};
pub use law::{Added, Law};
pub use own_model::{OwnModel, Rows};
pub use real::{JointStructure, RealExperiment, RealRecording, Structure};
pub use scene::Scene;
pub use sizing::Built;
pub use smoothed::Smoothed;
pub use split::{Presence, Split};
