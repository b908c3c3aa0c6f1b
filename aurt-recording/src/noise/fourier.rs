//! A Fourier transform of a power of two of samples.

/// Squared magnitudes |Σ x_k e^{−2πi km/n}|² for m = 0 … n/2 of a real series whose length n is a power of two, by the
/// radix-2 transform of Cooley and Tukey (1965).
pub(crate) fn power(series: &[f64]) -> Vec<f64> {
    let n = series.len();
    debug_assert!(n.is_power_of_two());
    let bits = n.trailing_zeros();
    let mut re = vec![0.0; n];
    let mut im = vec![0.0; n];
    for (k, value) in series.iter().enumerate() {
        let place = if bits == 0 { 0 } else { k.reverse_bits() >> (usize::BITS - bits) };
        re[place] = *value;
    }
    let mut half = 1;
    while half < n {
        for offset in 0..half {
            let (sin, cos) = libm::sincos(-std::f64::consts::PI * offset as f64 / half as f64);
            for a in (offset..n).step_by(2 * half) {
                let b = a + half;
                let (x, y) = (re[b] * cos - im[b] * sin, re[b] * sin + im[b] * cos);
                (re[b], im[b]) = (re[a] - x, im[a] - y);
                re[a] += x;
                im[a] += y;
            }
        }
        half *= 2;
    }
    (0..=n / 2).map(|m| re[m] * re[m] + im[m] * im[m]).collect()
}

#[cfg(test)]
pub(super) mod tests {
    use super::power;

    /// Nearly normal deviates of unit variance: the sum of twelve uniforms of a linear congruential sequence.
    pub(crate) struct Normal(u64);

    impl Normal {
        pub(crate) const fn new(seed: u64) -> Self {
            Self(seed)
        }

        pub(crate) fn next(&mut self) -> f64 {
            let mut uniform = || {
                self.0 =
                    self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (self.0 >> 11) as f64 / (1_u64 << 53) as f64
            };
            (0..12).map(|_| uniform()).sum::<f64>() - 6.0
        }
    }

    #[test]
    fn equals_the_sum_that_defines_it() {
        let mut normal = Normal::new(3);
        let series: Vec<f64> = (0..32).map(|_| normal.next()).collect();
        for (m, own) in power(&series).iter().enumerate() {
            let (mut re, mut im) = (0.0, 0.0);
            for (k, x) in series.iter().enumerate() {
                let angle = std::f64::consts::TAU * (k * m) as f64 / 32.0;
                re += x * angle.cos();
                im -= x * angle.sin();
            }
            assert!((own - (re * re + im * im)).abs() < 1e-10, "{m}");
        }
    }
}
