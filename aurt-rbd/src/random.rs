use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

/// Uniform pseudo-random numbers; the same seed gives the same numbers everywhere.
#[derive(Debug, Clone)]
pub(crate) struct Uniform(SplitMix64);

impl Uniform {
    pub fn from_seed(seed: u64) -> Self {
        Self(SplitMix64::seed_from_u64(seed))
    }

    /// The next number of [−reach, reach).
    pub fn within(&mut self, reach: f64) -> f64 {
        reach * (2.0 * ((self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64) - 1.0)
    }
}
