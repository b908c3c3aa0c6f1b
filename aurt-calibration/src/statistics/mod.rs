//! Deviates, and the distributions that tests and intervals need.

mod random;
mod student;

pub(crate) use random::Random;
pub(crate) use student::{low_chi_squared, normal};

pub use student::{ONE_SIDED_5, student, two_sided};
