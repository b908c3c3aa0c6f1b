use super::series::FullRate;

/// The energy along a joint's inertia over a piece.
#[derive(Debug, Clone, Copy)]
pub(super) struct Energy {
    /// Mean of D_j; 1 for noise.
    pub mean: f64,
    /// ⟨D²⟩/⟨D⟩²: 1.5 for a steady tone, 3 for steady noise, more for bursts.
    pub kurtosis: f64,
    /// Share of the whole arm's energy.
    pub share: f64,
}

/// How much of a shaking of the arm the motion of one link against its motor explains: while link j swings with the
/// acceleration x, the drives of all joints feel M(q) e_j x. For each sample, with the noise σ_i of band-passed
/// residuals h_i, the part of Σ h_i²/σ_i² along M e_j,
/// D_j = (Σ_i M_ij h_i/σ_i²)² / Σ_i M_ij²/σ_i²,
/// a χ² variable of one degree of freedom where there is only noise.
pub(super) struct Along {
    /// The samples at which joint j is calm: (sample, D_j, Σ_i h_i²/σ_i²).
    pub samples: Vec<(usize, f64, f64)>,
}

impl Along {
    /// Over a segment; `noise[i]` is that of the band-passed residual `band[i]`.
    pub fn new(full: &FullRate, band: &[Vec<f64>], noise: &[f64], joint: usize) -> Self {
        let samples = (0..full.time_s.len())
            .filter(|k| full.calm[joint][*k])
            .filter_map(|k| {
                let (mut product, mut length, mut all) = (0.0, 0.0, 0.0);
                for i in (0..full.joints()).filter(|i| full.calm[*i][k] && noise[*i] > 0.0) {
                    let (m, h) = (full.inertia.at(joint, i, k) / noise[i], band[i][k] / noise[i]);
                    product += m * h;
                    length += m * m;
                    all += h * h;
                }
                (length > 0.0).then(|| (k, product * product / length, all))
            })
            .collect();
        Self { samples }
    }

    /// What the samples come to.
    pub fn energy(&self) -> Energy {
        let n = self.samples.len().max(1) as f64;
        let mean = self.samples.iter().map(|s| s.1).sum::<f64>() / n;
        let square = self.samples.iter().map(|s| s.1 * s.1).sum::<f64>() / n;
        let all = self.samples.iter().map(|s| s.2).sum::<f64>() / n;
        Energy {
            mean,
            kurtosis: square / (mean * mean).max(f64::MIN_POSITIVE),
            share: mean / all.max(f64::MIN_POSITIVE),
        }
    }
}

impl Along {
    /// Mean of a quantity over the samples, weighted by the energy.
    pub fn mean_of(&self, quantity: impl Fn(usize) -> f64) -> f64 {
        let (sum, weight) = self
            .samples
            .iter()
            .fold((0.0, 0.0), |(sum, weight), (k, d, _)| (sum + d * quantity(*k), weight + d));
        sum / f64::max(weight, f64::MIN_POSITIVE)
    }

    /// Samples around which the mean energy over `half` neighbours on either side exceeds `level`.
    pub fn loud(&self, half: usize, level: f64) -> Vec<usize> {
        let mut sums = vec![0.0];
        for (_, d, _) in &self.samples {
            sums.push(sums[sums.len() - 1] + d);
        }
        (0..self.samples.len())
            .filter(|at| {
                let (from, to) = (at.saturating_sub(half), (at + half + 1).min(self.samples.len()));
                sums[to] - sums[from] > level * (to - from) as f64
            })
            .map(|at| self.samples[at].0)
            .collect()
    }
}
