//! Candidate columns freed of the baseline, of unit length, with the strongest kept.

use crate::evidence::baseline::weighted_fit;
use crate::evidence::gram::Moments;
use crate::evidence::linear::Cholesky;
use crate::hypotheses::group::Switch;
use crate::investigation::Investigation;

/// Columns that are kept: those most correlated with what the baseline leaves ("sure independence screening",
/// Fan & Lv 2008).
const KEPT: usize = 150;

/// Least squares over unit-length columns x_k that are orthogonal to the baseline: gram XᵀX, right Xᵀy.
pub(super) struct Standard {
    /// XᵀX, column-major.
    pub gram: Vec<f64>,
    /// Xᵀy.
    pub right: Vec<f64>,
    /// yᵀy after the baseline.
    pub square: f64,
    /// Rows.
    pub rows: f64,
}

/// Standardised moments of the kept columns: over everything, over each training part, over each test part.
pub(super) struct Standardised {
    /// The group of each column.
    pub groups: Vec<usize>,
    /// Over everything.
    pub total: Standard,
    /// Training and test part of each fold, in the total's units.
    pub folds: Vec<(Standard, Standard)>,
}

impl Standardised {
    pub fn new(investigation: &Investigation) -> Option<Self> {
        let problem = &investigation.problem;
        let base = &investigation.base_switches;
        let (_, weights) = weighted_fit(problem, base, &investigation.floor);
        let listed: Vec<(usize, Switch)> = investigation
            .groups
            .iter()
            .enumerate()
            .flat_map(|(g, group)| group.switches.iter().map(move |s| (g, *s)))
            .collect();
        let switches: Vec<Switch> = listed.iter().map(|(_, s)| *s).collect();
        let total = problem.total();
        // How much of what is left each column explains by itself.
        let n = base.len();
        let cholesky = Cholesky::new(&problem.cross(total, base, base, &weights), n);
        let mut forward = problem.right(total, base, &weights);
        cholesky.forward(&mut forward);
        let right = problem.right(total, &switches, &weights);
        let mut explained: Vec<(usize, f64)> = switches
            .iter()
            .enumerate()
            .filter_map(|(k, switch)| {
                let mut projected = problem.cross(total, base, std::slice::from_ref(switch), &weights);
                cholesky.forward(&mut projected);
                let own = problem.cross(total, &[*switch], &[*switch], &weights)[0];
                let length = own - dot(&projected, &projected);
                let inner = right[k] - dot(&projected, &forward);
                (length > 1e-6 * own && own > 0.0).then(|| (k, inner * inner / length))
            })
            .collect();
        explained.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        explained.truncate(KEPT);
        if explained.is_empty() {
            return None;
        }
        let kept: Vec<Switch> = explained.iter().map(|(k, _)| switches[*k]).collect();
        // One projection for all parts: that of the whole, so that parts add up.
        let projection = Projection::new(investigation, &kept, &weights, &cholesky);
        let whole = projection.moments(investigation, total, &weights);
        let scale: Vec<f64> = (0..kept.len())
            .map(|k| 1.0 / whole.gram[k * kept.len() + k].max(f64::MIN_POSITIVE).sqrt())
            .collect();
        let folds = (0..problem.blocks())
            .map(|block| {
                let (train, test) = problem.fold(block);
                (
                    projection.moments(investigation, train, &weights).scaled(&scale),
                    projection.moments(investigation, test, &weights).scaled(&scale),
                )
            })
            .collect();
        Some(Self {
            groups: explained.iter().map(|(k, _)| listed[*k].0).collect(),
            total: whole.scaled(&scale),
            folds,
        })
    }
}

/// x − B(BᵀB)⁻¹Bᵀx of every kept column and of the measurement, as coefficients of the baseline's columns.
struct Projection {
    all: Vec<Switch>,
    base: usize,
    /// Coefficients of the baseline for each kept column, then for the measurement.
    taken: Vec<Vec<f64>>,
}

impl Projection {
    fn new(investigation: &Investigation, kept: &[Switch], weights: &[f64], cholesky: &Cholesky) -> Self {
        let problem = &investigation.problem;
        let (base, total) = (&investigation.base_switches, problem.total());
        let n = base.len();
        let cross = problem.cross(total, base, kept, weights);
        let mut taken: Vec<Vec<f64>> =
            (0..kept.len()).map(|k| cholesky.solve(&cross[k * n..(k + 1) * n])).collect();
        taken.push(cholesky.solve(&problem.right(total, base, weights)));
        Self { all: base.iter().chain(kept).copied().collect(), base: n, taken }
    }

    fn moments(&self, investigation: &Investigation, part: &[Vec<Moments>; 2], weights: &[f64]) -> Standard {
        let problem = &investigation.problem;
        let (n, m) = (self.base, self.all.len());
        let kept = m - n;
        let matrix = problem.cross(part, &self.all, &self.all, weights);
        let right = problem.right(part, &self.all, weights);
        let base_times = |v: &[f64]| -> Vec<f64> {
            // [BᵀB; KᵀB] v over all rows of the matrix.
            let mut product = vec![0.0; m];
            for (k, value) in v.iter().enumerate().filter(|(_, value)| **value != 0.0) {
                for (p, x) in product.iter_mut().zip(&matrix[k * m..(k + 1) * m]) {
                    *p += value * x;
                }
            }
            product
        };
        let images: Vec<Vec<f64>> = self.taken.iter().map(|v| base_times(v)).collect();
        let measured = &self.taken[kept];
        let mut gram = vec![0.0; kept * kept];
        for b in 0..kept {
            for a in 0..kept {
                gram[b * kept + a] = matrix[(n + b) * m + n + a] - images[b][n + a] - images[a][n + b]
                    + dot(&self.taken[a], &images[b][..n]);
            }
        }
        let projected = (0..kept)
            .map(|k| {
                right[n + k] - images[kept][n + k] - dot(&self.taken[k], &right[..n])
                    + dot(&self.taken[k], &images[kept][..n])
            })
            .collect();
        let (mut square, mut rows) = (0.0, 0.0);
        for (j, weight) in weights.iter().enumerate() {
            for kind in part {
                square += weight * kind[j].square;
                rows += kind[j].rows;
            }
        }
        square += dot(measured, &images[kept][..n]) - 2.0 * dot(measured, &right[..n]);
        Standard { gram, right: projected, square, rows }
    }
}

impl Standard {
    fn scaled(mut self, scale: &[f64]) -> Self {
        let n = scale.len();
        for b in 0..n {
            for a in 0..n {
                self.gram[b * n + a] *= scale[a] * scale[b];
            }
            self.right[b] *= scale[b];
        }
        self
    }

    /// ‖y − Xβ‖² per row.
    pub fn error(&self, beta: &[f64]) -> f64 {
        let n = beta.len();
        let mut sum = self.square;
        for b in (0..n).filter(|b| beta[*b] != 0.0) {
            sum += beta[b] * (dot(&self.gram[b * n..(b + 1) * n], beta) - 2.0 * self.right[b]);
        }
        sum.max(0.0) / self.rows.max(1.0)
    }
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
