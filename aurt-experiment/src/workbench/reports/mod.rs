//! Pages of sweeps, sensitivities and tracked machines.

pub mod sensitivity;
pub mod sweep;
pub mod track;
