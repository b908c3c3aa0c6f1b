use rayon::prelude::*;

use crate::evidence::gram::{BlockMoments, Moments, dot};
use crate::evidence::linear::{Cholesky, solve_signed};
use crate::hypotheses::group::Switch;
use crate::recordings::partition::Partition;
use crate::recordings::rows::{Layout, RecordingRows};

/// Second moments in blocks of time, over all columns of baseline and candidates: all that nested models,
/// cross-validation and collinearity need.
#[derive(Debug, Clone)]
pub struct Problem {
    moments: BlockMoments,
    training: Vec<[Vec<Moments>; 2]>,
    local: Vec<Vec<usize>>,
    joints: usize,
}

const ABSENT: usize = usize::MAX;

/// A model fitted to every training part (all blocks but one), ready to be extended by further groups. Coefficients
/// that may not be negative are not in any part of the fit.
#[derive(Debug)]
pub struct NestedFit {
    /// Those of any sign, then those that may not be negative.
    switches: Vec<Switch>,
    /// Number of the former.
    free: usize,
    weights: Vec<f64>,
    folds: Vec<PartFit>,
}

/// The least squares of a nested model over one part of the data: coefficients of any sign eliminated, the normal
/// equations of the others left.
#[derive(Debug)]
pub(crate) struct PartFit {
    cholesky: Cholesky,
    /// L⁻¹Xᵀy.
    forward: Vec<f64>,
    /// L⁻¹XᵀZ for the signed columns Z.
    projected: Vec<f64>,
    /// ZᵀZ and Zᵀy after the elimination.
    schur: Vec<f64>,
    right: Vec<f64>,
}

impl PartFit {
    /// Solves L x = b in place.
    pub(crate) fn forward(&self, b: &mut [f64]) {
        self.cholesky.forward(b);
    }

    /// Solves Lᵀx = b in place.
    pub(crate) fn backward(&self, b: &mut [f64]) {
        self.cholesky.backward(b);
    }
}

/// Below this share of its squared length a column is one of those already in the model: what is left of it is
/// rounding.
pub(crate) const ROUNDING: f64 = 1e-10;

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
            if weights[joint] == 0.0 {
                continue;
            }
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

    /// Σ_j weight_j X_aᵀy from products of a joint's columns with another measurement, `[kind][joint][column]`.
    pub(crate) fn right_of(&self, products: &[Vec<Vec<f64>>; 2], a: &[Switch], weights: &[f64]) -> Vec<f64> {
        let of_switch = |switch: &Switch| {
            let of_joint = |(j, weight): (usize, &f64)| {
                let local = self.local[j][switch.column];
                if *weight == 0.0 || local == ABSENT {
                    return 0.0;
                }
                let calibration = if switch.target_only { 0.0 } else { products[0][j][local] };
                weight * (calibration + products[1][j][local])
            };
            weights.iter().enumerate().map(of_joint).sum()
        };
        a.iter().map(of_switch).collect()
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
    pub(crate) fn squared_errors(
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
        let (switches, free) = free_first(switches);
        let fit = |train: &[Vec<Moments>; 2]| self.part_fit(train, &switches, free, weights);
        let folds = self.training.par_iter().map(fit).collect();
        NestedFit { free, weights: weights.to_vec(), folds, switches }
    }

    /// The least squares of switches, the first `free` of any sign, over a part of the data.
    pub(crate) fn part_fit(
        &self,
        part: &[Vec<Moments>; 2],
        switches: &[Switch],
        free: usize,
        weights: &[f64],
    ) -> PartFit {
        let (any, signed) = switches.split_at(free);
        let cholesky = Cholesky::new(&self.cross(part, any, any, weights), free);
        let mut forward = self.right(part, any, weights);
        cholesky.forward(&mut forward);
        let empty = PartFit { cholesky, forward, projected: vec![], schur: vec![], right: vec![] };
        let (projected, schur, right) = self.extended(part, &empty, any, &[], signed, weights);
        PartFit { projected, schur, right, ..empty }
    }

    /// (L⁻¹XᵀZ, ZᵀZ, Zᵀy) after the elimination, for the signed columns of a fit and those of a group.
    fn extended(
        &self,
        part: &[Vec<Moments>; 2],
        fit: &PartFit,
        any: &[Switch],
        signed: &[Switch],
        group: &[Switch],
        weights: &[f64],
    ) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let (n, s, g) = (any.len(), signed.len(), group.len());
        let mut projected = self.cross(part, any, group, weights);
        if n > 0 {
            projected.chunks_exact_mut(n).for_each(|column| fit.cholesky.forward(column));
        }
        let all = [&fit.projected[..], &projected[..]].concat();
        let of = |k: usize| &all[k * n..(k + 1) * n];
        let beside = self.cross(part, signed, group, weights);
        let own = self.cross(part, group, group, weights);
        let m = s + g;
        let mut schur = vec![0.0; m * m];
        for k in 0..s {
            schur[k * m..k * m + s].copy_from_slice(&fit.schur[k * s..(k + 1) * s]);
        }
        for b in 0..g {
            for a in 0..m {
                let product = if a < s { beside[b * s + a] } else { own[b * g + a - s] };
                let mut value = product - dot(of(a), of(s + b));
                if a == s + b && value <= ROUNDING * product {
                    value = 0.0;
                }
                schur[(s + b) * m + a] = value;
                schur[a * m + s + b] = value;
            }
        }
        let mut right = fit.right.clone();
        let measured = self.right(part, group, weights);
        right.extend(measured.iter().enumerate().map(|(b, y)| y - dot(of(s + b), &fit.forward)));
        (all, schur, right)
    }

    /// Coefficients of the nested switches and then of a group that extends them.
    pub(crate) fn extend(
        &self,
        part: &[Vec<Moments>; 2],
        fit: &PartFit,
        (switches, free): (&[Switch], usize),
        group: &[Switch],
        weights: &[f64],
    ) -> Vec<f64> {
        let (any, signed) = switches.split_at(free);
        let (projected, schur, right) = self.extended(part, fit, any, signed, group, weights);
        let nonnegative: Vec<bool> = signed.iter().chain(group).map(|s| s.nonnegative).collect();
        let extension = solve_signed(&schur, &right, &nonnegative);
        let mut beta = fit.forward.clone();
        for (k, value) in extension.iter().enumerate().filter(|(_, v)| **v != 0.0) {
            for (x, p) in beta.iter_mut().zip(&projected[k * free..(k + 1) * free]) {
                *x -= value * p;
            }
        }
        fit.cholesky.backward(&mut beta);
        beta.extend(extension);
        beta
    }

    /// Cross-validated squared error of each joint, `[kind][joint]`, of the nested model extended by `group`.
    #[must_use]
    pub fn held_out(&self, fit: &NestedFit, group: &[Switch]) -> [Vec<f64>; 2] {
        let all: Vec<Switch> = fit.switches.iter().chain(group).copied().collect();
        let mut sums = [vec![0.0; self.joints], vec![0.0; self.joints]];
        for ((train, test), fold) in self.training.iter().zip(&self.moments.parts).zip(&fit.folds) {
            let beta = self.extend(train, fold, (&fit.switches, fit.free), group, &fit.weights);
            let errors = self.squared_errors(test, &all, &beta);
            for (sum, error) in sums.iter_mut().flatten().zip(errors.iter().flatten()) {
                *sum += error;
            }
        }
        sums
    }

    /// The same columns with another measurement of some joints: XᵀX stays, Xᵀy and yᵀy are those of the rows.
    pub(crate) fn measured_anew(
        &self,
        recordings: &[RecordingRows],
        partition: &Partition,
        joints: &[usize],
    ) -> Self {
        let mut anew = self.clone();
        anew.moments.measure(recordings, partition, joints);
        let Self { moments, training, .. } = &mut anew;
        for (rest, part) in training.iter_mut().zip(&moments.parts) {
            for kind in 0..2 {
                for joint in joints {
                    let (total, part) = (&moments.total[kind][*joint], &part[kind][*joint]);
                    let rest = &mut rest[kind][*joint];
                    for ((rest, all), own) in rest.right.iter_mut().zip(&total.right).zip(&part.right) {
                        *rest = all - own;
                    }
                    rest.square = total.square - part.square;
                }
            }
        }
        anew
    }

    /// Takes the moments of some columns of a joint anew, after its rows have changed; `columns` count among the
    /// joint's own.
    pub(crate) fn renew(
        &mut self,
        recordings: &[RecordingRows],
        partition: &Partition,
        joint: usize,
        columns: &[usize],
    ) {
        self.moments.renew(recordings, partition, joint, columns);
        let Self { moments, training, .. } = self;
        for (rest, part) in training.iter_mut().zip(&moments.parts) {
            for kind in 0..2 {
                let (total, part) = (&moments.total[kind][joint], &part[kind][joint]);
                let rest = &mut rest[kind][joint];
                let n = total.columns;
                for k in columns {
                    for c in 0..n {
                        let value = total.gram[k * n + c] - part.gram[k * n + c];
                        rest.gram[k * n + c] = value;
                        rest.gram[c * n + k] = value;
                    }
                    rest.right[*k] = total.right[*k] - part.right[*k];
                }
            }
        }
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
        let (ordered, free) = free_first(switches);
        let fit = self.part_fit(total, &ordered, free, weights);
        let mut values = self.extend(total, &fit, (&ordered, free), &[], weights).into_iter();
        let mut coefficients = vec![0.0; n];
        for signed in [false, true] {
            for k in (0..n).filter(|k| switches[*k].nonnegative == signed) {
                coefficients[k] = values.next().unwrap_or(0.0);
            }
        }
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

/// Switches of any sign, then those that may not be negative, and the number of the former.
pub(crate) fn free_first(switches: &[Switch]) -> (Vec<Switch>, usize) {
    let (signed, any): (Vec<Switch>, Vec<Switch>) = switches.iter().partition(|s| s.nonnegative);
    let free = any.len();
    (any.into_iter().chain(signed).collect(), free)
}
