//! How sure it is that another setup explains the held-out data better than the one that is there.

use aurt_calibration::two_sided;
use serde_json::{Value, json};

use super::trial::Score;

/// Right setups that are accused, at most.
const FALSE_ACCUSATIONS: f64 = 0.005;
/// Searches that can accuse a right setup: of the whole setup, of one recording, of another robot.
pub const TESTS: usize = 3;
/// Gain from which on a setup is told. What rigid bodies with plain friction leave out makes some wrong setups surely better than
/// the right one, but by less (docs/mistakes.md).
pub const LEAST_GAIN: f64 = 0.15;

/// Vuong's comparison (1989, *Econometrica* 57) of two setups that are fitted to the same rows and judged on others.
///
/// The likelihood of a row, with a relative deviation r_j of its own for each joint, is ℓ = Σ_j −ln r_j − e_j²/(2σ_j²) + 1/2. What
/// one setup has more of it than the other is averaged over batches: √n batches of √n rows each, since neighbouring rows err
/// alike. Where the other setup is no better but for what no setup models, the mean over its standard error is Student's t.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Evidence {
    /// Mean over rows and joints of the logarithm of the likelihood ratio: of ln(r before / r after).
    pub gain: f64,
    /// Its standard error.
    pub deviation: f64,
    /// Batches.
    pub batches: usize,
}

impl Evidence {
    /// What tells setups from those before, both judged on the same parts of recordings; without a fit before, nothing was
    /// explained.
    pub fn of<'s>(pairs: impl IntoIterator<Item = (Option<&'s Score>, &'s Score)>) -> Option<Self> {
        let mut differences = Vec::new();
        for (before, after) in pairs {
            let joints = after.joints.iter().flatten().count().max(1) as f64;
            for (k, part) in after.parts.iter().enumerate() {
                let rows = part.first().map_or(0, Vec::len);
                let batches = rows.isqrt();
                let own = after.likelihoods(k, batches);
                let others = before.map_or_else(|| vec![0.0; batches], |b| b.likelihoods(k, batches));
                differences.extend(own.iter().zip(others).map(|(a, b)| (a - b) / joints));
            }
        }
        let batches = differences.len();
        let n = batches as f64;
        let gain = differences.iter().sum::<f64>() / n;
        let variance = differences.iter().map(|d| (d - gain).powi(2)).sum::<f64>() / (n - 1.0);
        let deviation = (variance / n).sqrt();
        deviation.is_finite().then_some(Self { gain, deviation, batches })
    }

    /// For programs.
    pub fn to_json(self) -> Value {
        json!({ "gain": self.gain, "deviation": self.deviation, "batches": self.batches })
    }

    /// Whether the gain is more than chance, if it is the best of so many.
    pub fn is_sure(&self, of: usize) -> bool {
        let t = self.gain / self.deviation;
        let probability = 0.5 * two_sided(t, self.batches as f64 - 1.0);
        t > 0.0 && probability * (of as f64) < FALSE_ACCUSATIONS
    }
}
