//! What noise alone leaves of a recording.
//!
//! White noise of the measurement and its memory, and the positions' noise (white, and the lattice of the encoder),
//! which reaches the residual through what the fitted model makes of positions, velocities and accelerations: as
//! spectra ([`spectrum`]), as the mean square that the residual of a right model has ([`floor`]), and as a filter that
//! makes such a residual white ([`whitening`]).

pub mod floor;
pub mod inertia;
pub(crate) mod instrument;
mod residual;
mod sensitivity;
pub mod spectrum;
pub mod whitening;
