use rayon::prelude::*;

use crate::evidence::gram::{BlockMoments, Moments};
use crate::evidence::linear::{Cholesky, solve_signed};
use crate::hypotheses::group::Switch;
use crate::recordings::rows::Layout;

/// Second moments in blocks of time, over all columns of baseline and candidates: all that nested models,
/// cross-validation and collinearity need.
#[derive(Debug)]
pub struct Problem {
    moments: BlockMoments,
    training: Vec<[Vec<Moments>; 2]>,
    local: Vec<Vec<usize>>,
    joints: usize,
}

const ABSENT: usize = usize::MAX;

/// A model fitted to every training part (all blocks but one), ready to be extended by further groups.
#[derive(Debug)]
pub struct NestedFit {
    switches: Vec<Switch>,
    weights: Vec<f64>,
    folds: Vec<FoldFit>,
}

#[derive(Debug)]
struct FoldFit {
    cholesky: Cholesky,
    forward: Vec<f64>,
}

impl Problem {
    /// A problem over the columns of a layout.
    #[must_use]
    pub fn new(layout: &Layout, moments: BlockMoments) -> Self {
        let joints = layout.rows.len();
        let local = (0..joints)
            .map(|j| {
                let mut map = vec![ABSENT; layout.coefficients];
                for (k, column) in layout.rows[j].iter().enumerate() {
                    map[*column] = k;
                }
                map
            })
            .collect();
        let training = (0..moments.parts.len()).map(|b| moments.without(b)).collect();
        Self { moments, training, local, joints }
    }

    /// Number of blocks.
    #[must_use]
    pub fn blocks(&self) -> usize {
        self.training.len()
    }

    /// Number of joints.
    #[must_use]
    pub const fn joints(&self) -> usize {
        self.joints
    }

    /// Rows of each joint over all blocks; `target` counts target recordings only.
    #[must_use]
    pub fn rows(&self, joint: usize, target: bool) -> f64 {
        let [calibration, other] = &self.moments.total;
        other[joint].rows + if target { 0.0 } else { calibration[joint].rows }
    }

    /// Whether there are target recordings.
    #[must_use]
    pub fn has_target(&self) -> bool {
        self.moments.total[1].iter().any(|m| m.rows > 0.0)
    }

    /// Whether there are recordings beside the targets.
    #[must_use]
    pub fn has_reference(&self) -> bool {
        self.moments.total[0].iter().any(|m| m.rows > 0.0)
    }

    /// Moments of everything, `[kind][joint]`.
    pub(crate) const fn total(&self) -> &[Vec<Moments>; 2] {
        &self.moments.total
    }

    /// Moments of everything but a block, and of the block.
    pub(crate) fn fold(&self, block: usize) -> (&[Vec<Moments>; 2], &[Vec<Moments>; 2]) {
        (&self.training[block], &self.moments.parts[block])
    }

    /// Σ_j weight_j X_aᵀX_b over a set of moments, column-major |a| × |b|.
    pub(crate) fn cross(
        &self,
        moments: &[Vec<Moments>; 2],
        a: &[Switch],
        b: &[Switch],
        weights: &[f64],
    ) -> Vec<f64> {
        let mut matrix = vec![0.0; a.len() * b.len()];
        for joint in 0..self.joints {
            let map = &self.local[joint];
            let rows: Vec<(usize, usize, bool)> = a
                .iter()
                .enumerate()
                .filter(|(_, s)| map[s.column] != ABSENT)
                .map(|(i, s)| (i, map[s.column], s.target_only))
                .collect();
            for (k, switch) in b.iter().enumerate().filter(|(_, s)| map[s.column] != ABSENT) {
                let column = map[switch.column];
                for (kind, part) in moments.iter().enumerate() {
                    if kind == 0 && switch.target_only {
                        continue;
                    }
                    let m = &part[joint];
                    let gram = &m.gram[column * m.columns..(column + 1) * m.columns];
                    for (i, row, target_only) in &rows {
                        if kind == 1 || !target_only {
                            matrix[k * a.len() + i] += weights[joint] * gram[*row];
                        }
                    }
                }
            }
        }
        matrix
    }

    /// Σ_j weight_j X_aᵀy over a set of moments.
    pub(crate) fn right(&self, moments: &[Vec<Moments>; 2], a: &[Switch], weights: &[f64]) -> Vec<f64> {
        a.iter()
            .map(|switch| {
                let mut sum = 0.0;
                for joint in 0..self.joints {
                    let local = self.local[joint][switch.column];
                    if local == ABSENT {
                        continue;
                    }
                    for (kind, part) in moments.iter().enumerate() {
                        if kind == 1 || !switch.target_only {
                            sum += weights[joint] * part[joint].right[local];
                        }
                    }
                }
                sum
            })
            .collect()
    }

    /// ‖y_j − X_j β‖² of each joint over a set of moments, `[kind][joint]`.
    fn squared_errors(
        &self,
        moments: &[Vec<Moments>; 2],
        switches: &[Switch],
        beta: &[f64],
    ) -> [Vec<f64>; 2] {
        [0, 1].map(|kind| {
            (0..self.joints)
                .map(|joint| {
                    let m = &moments[kind][joint];
                    if m.rows <= 0.0 {
                        return 0.0;
                    }
                    let map = &self.local[joint];
                    let terms: Vec<(usize, f64)> = switches
                        .iter()
                        .zip(beta)
                        .filter(|(s, b)| {
                            map[s.column] != ABSENT && (kind == 1 || !s.target_only) && **b != 0.0
                        })
                        .map(|(s, b)| (map[s.column], *b))
                        .collect();
                    let mut sum = m.square;
                    for (a, value) in &terms {
                        let gram = &m.gram[a * m.columns..(a + 1) * m.columns];
                        let quadratic: f64 = terms.iter().map(|(b, other)| gram[*b] * other).sum();
                        sum += value * (quadratic - 2.0 * m.right[*a]);
                    }
                    sum.max(0.0)
                })
                .collect()
        })
    }

    /// Fits `switches` to every training part.
    #[must_use]
    pub fn nest(&self, switches: &[Switch], weights: &[f64]) -> NestedFit {
        let folds = self
            .training
            .par_iter()
            .map(|train| {
                let n = switches.len();
                let cholesky = Cholesky::new(&self.cross(train, switches, switches, weights), n);
                let mut forward = self.right(train, switches, weights);
                cholesky.forward(&mut forward);
                FoldFit { cholesky, forward }
            })
            .collect();
        NestedFit { switches: switches.to_vec(), weights: weights.to_vec(), folds }
    }

    /// Cross-validated squared error of each joint, `[kind][joint]`, of the nested model extended by `group`.
    #[must_use]
    pub fn held_out(&self, fit: &NestedFit, group: &[Switch]) -> [Vec<f64>; 2] {
        let all: Vec<Switch> = fit.switches.iter().chain(group).copied().collect();
        let nonnegative: Vec<bool> = group.iter().map(|s| s.nonnegative).collect();
        let (n, g) = (fit.switches.len(), group.len());
        let mut sums = [vec![0.0; self.joints], vec![0.0; self.joints]];
        for ((train, test), fold) in self.training.iter().zip(&self.moments.parts).zip(&fit.folds) {
            let mut projected = self.cross(train, &fit.switches, group, &fit.weights);
            projected.chunks_exact_mut(n.max(1)).for_each(|column| fold.cholesky.forward(column));
            let mut schur = self.cross(train, group, group, &fit.weights);
            let mut right = self.right(train, group, &fit.weights);
            for b in 0..g {
                let pb = &projected[b * n..(b + 1) * n];
                for a in 0..g {
                    schur[b * g + a] -= dot(&projected[a * n..(a + 1) * n], pb);
                }
                right[b] -= dot(pb, &fold.forward);
            }
            let extension = solve_signed(&schur, &right, &nonnegative);
            let mut beta = fold.forward.clone();
            for (k, value) in extension.iter().enumerate() {
                for (x, p) in beta.iter_mut().zip(&projected[k * n..(k + 1) * n]) {
                    *x -= value * p;
                }
            }
            fold.cholesky.backward(&mut beta);
            beta.extend(extension);
            let errors = self.squared_errors(test, &all, &beta);
            for (sum, error) in sums.iter_mut().flatten().zip(errors.iter().flatten()) {
                *sum += error;
            }
        }
        sums
    }

    /// The share of each group column's torque, whitened by `weights`, that `switches` cannot absorb: 0 where
    /// it is absorbed exactly.
    #[must_use]
    pub fn free_share(&self, switches: &[Switch], group: &[Switch], weights: &[f64]) -> Vec<f64> {
        let total = &self.moments.total;
        let n = switches.len();
        let cholesky = Cholesky::new(&self.cross(total, switches, switches, weights), n);
        let mut projected = self.cross(total, switches, group, weights);
        let own = self.cross(total, group, group, weights);
        (0..group.len())
            .map(|k| {
                let column = &mut projected[k * n..(k + 1) * n];
                cholesky.forward(column);
                let length = own[k * group.len() + k];
                if length > 0.0 { ((length - dot(column, column)) / length).max(0.0).sqrt() } else { 0.0 }
            })
            .collect()
    }

    /// Least squares over all blocks: coefficients and their covariance (unit weights mean unit variance).
    #[must_use]
    pub fn fit(&self, switches: &[Switch], weights: &[f64]) -> TotalFit {
        let total = &self.moments.total;
        let n = switches.len();
        let matrix = self.cross(total, switches, switches, weights);
        let right = self.right(total, switches, weights);
        let nonnegative: Vec<bool> = switches.iter().map(|s| s.nonnegative).collect();
        let coefficients = solve_signed(&matrix, &right, &nonnegative);
        let cholesky = Cholesky::new(&matrix, n);
        let variance = (0..n)
            .map(|k| {
                let mut unit = vec![0.0; n];
                unit[k] = 1.0;
                cholesky.forward(&mut unit);
                if cholesky.used()[k] { dot(&unit, &unit) } else { f64::INFINITY }
            })
            .collect();
        let squared_errors = self.squared_errors(total, switches, &coefficients);
        TotalFit { coefficients, variance, squared_errors }
    }
}

/// A fit over all blocks.
#[derive(Debug, Clone)]
pub struct TotalFit {
    /// Coefficients, in the order of the switches.
    pub coefficients: Vec<f64>,
    /// Their variances for unit-variance weighted rows; infinite where not excited.
    pub variance: Vec<f64>,
    /// Squared error, `[kind][joint]`.
    pub squared_errors: [Vec<f64>; 2],
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
