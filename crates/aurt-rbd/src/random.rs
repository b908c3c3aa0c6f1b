/// Uniform pseudo-random numbers from a seed: SplitMix64 (Steele, Lea, Flood, *Fast splittable
/// pseudorandom number generators*, OOPSLA 2014). The same seed gives the same numbers everywhere.
#[derive(Debug, Clone)]
pub(crate) struct Uniform(u64);

impl Uniform {
    pub fn from_seed(seed: u64) -> Self {
        Self(seed)
    }

    /// The next number of [−reach, reach).
    pub fn within(&mut self, reach: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        reach * (2.0 * ((z >> 11) as f64 / (1_u64 << 53) as f64) - 1.0)
    }
}
