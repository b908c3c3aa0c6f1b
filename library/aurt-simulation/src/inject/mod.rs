//! Real recordings with an effect added: the world `injected`.
//!
//! The background is a real robot's: its friction, its noise, its clock. The effect is known, because it is computed
//! from the measured positions and added to what the joints measured. Nothing here is shared with what diagnoses or
//! calibrates: positions are smoothed and differentiated by local polynomials ([`Smoothed`]), the robot's own model is a
//! small least squares ([`OwnModel`]), and laws are written down anew ([`Law`]).
//!
//! An injection changes the measurement alone. A real effect would also change the motion, by a little, through the
//! controller; with the motion given, the torque that the joints need is the same.
//!
//! ```text
//! RealExperiment ─► Injection ─► reference(name): the recordings as they are
//!                       └──────► make(request, seed, name): an effect in the targets, or in all recordings
//! ```

mod added;
mod bodies;
mod build;
mod case;
mod describe;
mod drawing;
mod friction;
mod injection;
mod instrument;
mod kinds;
mod law;
mod outside;
mod own_model;
mod real;
mod resonator;
mod scene;
mod smoothed;
mod split;

pub use added::Added;
pub use build::Built;
pub use describe::SizeName;
pub use injection::{Injection, Recorded};
pub use kinds::{Kind, injectable, strange};
pub use law::Law;
pub use own_model::OwnModel;
pub use real::{RealExperiment, RealRecording};
pub use scene::Scene;
pub use smoothed::Smoothed;
pub use split::{Presence, Split};
