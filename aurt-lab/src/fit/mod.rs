//! A small least squares of a robot's own structure, for measuring how much of an effect that structure could
//! absorb and how much noise it leaves. It is no calibration: the structure is the simulator's, fixed, and
//! nothing of it is reported but residuals.

mod decidable;
mod noise_free;
mod processed;

pub use processed::processed_motion;

pub(crate) use decidable::without_absorbed_rotors;
pub(crate) use noise_free::{NoiseFreeFit, Samples};
