use std::sync::Arc;

use crate::evidence::given::GivenCovariance;
use crate::evidence::gram::{BlockMoments, Moments, dot};
use crate::evidence::linear::{Cholesky, solve_signed_from};
use crate::hypotheses::group::Switch;
use crate::recordings::partition::Partition;
use crate::recordings::rows::{Layout, RecordingRows};

/// Second moments in blocks of time, over all columns of baseline and candidates: all that nested models,
/// cross-validation and collinearity need.
#[derive(Debug, Clone)]
pub struct Problem {
    pub(super) moments: BlockMoments,
    pub(super) training: Vec<[Vec<Moments>; 2]>,
    local: Vec<Vec<usize>>,
    pub(super) joints: usize,
    /// Covariance of the coefficients of a given model, if it is known.
    pub(crate) given: Option<Arc<GivenCovariance>>,
}

/// A column of a model among those of a joint's rows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    /// Place among the switches of the model.
    pub(super) at: usize,
    /// Place among the columns of the joint.
    pub(super) local: usize,
    pub(super) target_only: bool,
}

const ABSENT: usize = usize::MAX;

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
    pub(super) schur: Vec<f64>,
    pub(super) right: Vec<f64>,
}

impl PartFit {
    /// Solves L x = b in place.
    pub(crate) fn forward(&self, b: &mut [f64]) {
        self.cholesky.forward(b);
    }

    /// Number of coefficients of any sign.
    pub(super) const fn free(&self) -> usize {
        self.forward.len()
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
        Self { moments, training, local, joints, given: None }
    }

    /// Number of blocks.
    pub fn blocks(&self) -> usize {
        self.training.len()
    }

    /// Number of joints.
    pub const fn joints(&self) -> usize {
        self.joints
    }

    /// Rows of each joint over all blocks; `target` counts target recordings only.
    pub fn rows(&self, joint: usize, target: bool) -> f64 {
        let [calibration, other] = &self.moments.total;
        other[joint].rows + if target { 0.0 } else { calibration[joint].rows }
    }

    /// Whether there are target recordings.
    pub fn has_target(&self) -> bool {
        self.moments.total[1].iter().any(|m| m.rows > 0.0)
    }

    /// Whether there are recordings beside the targets.
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

    /// Σ_j weight_j ‖X β‖² over a set of moments.
    pub(crate) fn quadratic(
        &self,
        moments: &[Vec<Moments>; 2],
        switches: &[Switch],
        beta: &[f64],
        weights: &[f64],
    ) -> f64 {
        let gram = self.cross(moments, switches, switches, weights);
        beta.iter().zip(gram.chunks_exact(beta.len().max(1))).map(|(b, row)| b * dot(row, beta)).sum()
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
        let (projected, schur, right) =
            self.extended(part, &empty, &self.places(any), (free, 0), signed, weights);
        PartFit { projected, schur, right, ..empty }
    }

    /// Where columns stand in the rows of each joint.
    pub(super) fn places(&self, switches: &[Switch]) -> Vec<Vec<Place>> {
        let of_joint = |map: &Vec<usize>| {
            let all = switches.iter().enumerate();
            let places = all.map(|(at, s)| Place { at, local: map[s.column], target_only: s.target_only });
            places.filter(|p| p.local != ABSENT).collect()
        };
        self.local.iter().map(of_joint).collect()
    }

    /// (L⁻¹XᵀZ, ZᵀZ, Zᵀy) after the elimination of the first `free` columns of a model at `nested`, for its `signed` others
    /// and then those of a group; the first is of the group alone.
    pub(super) fn extended(
        &self,
        part: &[Vec<Moments>; 2],
        fit: &PartFit,
        nested: &[Vec<Place>],
        (free, signed): (usize, usize),
        group: &[Switch],
        weights: &[f64],
    ) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let g = group.len();
        let n = free + signed;
        let mut products = vec![0.0; n * g];
        let mut own = vec![0.0; g * g];
        let mut measured = vec![0.0; g];
        for (j, (columns, nested)) in self.places(group).iter().zip(nested).enumerate() {
            let weight = weights[j];
            if weight == 0.0 {
                continue;
            }
            for column in columns {
                let with = Products::of(part, j, *column);
                let out = &mut products[column.at * n..(column.at + 1) * n];
                nested.iter().for_each(|p| out[p.at] += weight * with.column(*p));
                let out = &mut own[column.at * g..(column.at + 1) * g];
                columns.iter().for_each(|p| out[p.at] += weight * with.column(*p));
                measured[column.at] += weight * with.measurement();
            }
        }
        let mut projected = Vec::with_capacity(free * g);
        for b in 0..g {
            let column = &mut products[b * n..b * n + free];
            fit.cholesky.forward(column);
            projected.extend_from_slice(column);
        }
        let m = signed + g;
        let mut schur = vec![0.0; m * m];
        for k in 0..signed {
            schur[k * m..k * m + signed].copy_from_slice(&fit.schur[k * signed..(k + 1) * signed]);
        }
        let mut right = fit.right.clone();
        for (b, measured) in measured.iter().enumerate() {
            let of_b = &projected[b * free..(b + 1) * free];
            for a in 0..m {
                let (product, of_a) = match a.checked_sub(signed) {
                    None => (products[b * n + free + a], &fit.projected[a * free..(a + 1) * free]),
                    Some(a) => (own[b * g + a], &projected[a * free..(a + 1) * free]),
                };
                let mut value = product - dot(of_a, of_b);
                if a == signed + b && value <= ROUNDING * product {
                    value = 0.0;
                }
                schur[(signed + b) * m + a] = value;
                schur[a * m + signed + b] = value;
            }
            right.push(measured - dot(of_b, &fit.forward));
        }
        (projected, schur, right)
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
        let passive = vec![true; switches.len() - free];
        self.extend_from(part, (fit, &passive), &self.places(switches), group, weights)
    }

    /// The same, with the places of the nested switches, and those of its signed columns that are likely to be above zero.
    pub(super) fn extend_from(
        &self,
        part: &[Vec<Moments>; 2],
        (fit, likely): (&PartFit, &[bool]),
        nested: &[Vec<Place>],
        group: &[Switch],
        weights: &[f64],
    ) -> Vec<f64> {
        let (free, signed) = (fit.forward.len(), likely.len());
        let (projected, schur, right) = self.extended(part, fit, nested, (free, signed), group, weights);
        let mut nonnegative = vec![true; signed];
        nonnegative.extend(group.iter().map(|s| s.nonnegative));
        let mut passive = likely.to_vec();
        passive.resize(signed + group.len(), true);
        let extension = solve_signed_from(&schur, &right, &nonnegative, passive);
        let mut beta = fit.forward.clone();
        let columns = fit.projected.chunks_exact(free.max(1)).take(signed);
        let columns = columns.chain(projected.chunks_exact(free.max(1)));
        for (value, column) in extension.iter().zip(columns).filter(|(v, _)| **v != 0.0) {
            beta.iter_mut().zip(column).for_each(|(x, p)| *x -= value * p);
        }
        fit.cholesky.backward(&mut beta);
        beta.extend(extension);
        beta
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
    pub fn free_share(&self, switches: &[Switch], group: &[Switch], weights: &[f64]) -> Vec<f64> {
        let (n, total) = (switches.len(), &self.moments.total);
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
}

/// Products of one column of a joint's rows with the others, over a part of the data.
#[derive(Clone, Copy)]
pub(super) struct Products<'a> {
    /// Of calibration recordings, where the column counts in them, and of targets: its part of the Gram matrix, and
    /// its product with the measurement.
    calibration: Option<(&'a [f64], f64)>,
    target: (&'a [f64], f64),
}

impl<'a> Products<'a> {
    pub(super) fn of(part: &'a [Vec<Moments>; 2], joint: usize, column: Place) -> Self {
        let of_kind = |kind: usize| {
            let m: &Moments = &part[kind][joint];
            (&m.gram[column.local * m.columns..(column.local + 1) * m.columns], m.right[column.local])
        };
        Self { calibration: (!column.target_only).then(|| of_kind(0)), target: of_kind(1) }
    }

    pub(super) fn column(&self, other: Place) -> f64 {
        let calibration = self.calibration.filter(|_| !other.target_only).map_or(0.0, |c| c.0[other.local]);
        calibration + self.target.0[other.local]
    }

    pub(super) fn measurement(&self) -> f64 {
        self.calibration.map_or(0.0, |c| c.1) + self.target.1
    }
}
