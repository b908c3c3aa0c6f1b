//! What recordings say, as one triangle per joint, and its solutions.

mod estimate;
mod factor;
mod triangles;

pub(crate) use estimate::{estimate_coefficients, noise_scale, ones, variance, weights};
pub(crate) use triangles::{Triangle, triangularise};

pub use estimate::{Estimate, estimate};
pub use factor::JointFactor;
pub use triangles::{Solution, System};
