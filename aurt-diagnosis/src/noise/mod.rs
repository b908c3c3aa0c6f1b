//! What noise alone leaves of a recording.
//!
//! White noise of the measurement and its memory, and the positions' noise (white, and the lattice of the encoder),
//! which reaches the residual through what the fitted model makes of positions, velocities and accelerations: as
//! spectra ([`spectrum`]), and as the mean square that the residual of a right model has ([`floor`]).

pub mod floor;
pub(crate) mod instrument;
pub mod pose;
mod residual;
mod sensitivity;
pub mod spectrum;
