//! What the rows of a recording show of how they were sampled: the unit of stamps, interpolation, the frequencies of the motion.

mod bandwidth;
mod interpolated;
pub(crate) mod stamps;

pub use bandwidth::{quiet_f_dyn_hz, suitable_f_dyn_hz};
pub use stamps::StampUnit;
