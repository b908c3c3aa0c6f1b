//! The evidence for a constant force over any stretch of rows, from prefix sums.

use nalgebra::{Matrix3, Vector3};

use super::ForceColumns;
use crate::evidence::baseline::BLOCKS;
use crate::evidence::problem::ROUNDING;

/// Normal equations of a link's force, summed from the first row: A (upper triangle), g.
pub(super) struct Prefix {
    sums: Vec<[f64; 9]>,
}

/// A stretch of rows and how much of its whitened residual a constant force explains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stretch {
    pub(super) statistic: f64,
    start: usize,
    end: usize,
}

impl Stretch {
    pub(super) fn span(&self) -> [usize; 2] {
        [self.start, self.end]
    }

    /// Whether it shares rows with a span.
    pub(super) fn meets(&self, [start, end]: [usize; 2]) -> bool {
        self.start < end && start < self.end
    }
}

impl Prefix {
    pub(super) fn new(
        forces: &ForceColumns,
        residual: &[Vec<f64>],
        usable: &[Vec<bool>],
        sigma: &[f64],
    ) -> Self {
        let rows = residual.first().map_or(0, Vec::len);
        let mut each = vec![[0.0; 9]; rows + 1];
        for (joint, series) in residual.iter().enumerate() {
            let [x, y, z] = [0, 1, 2].map(|axis| forces.axes[axis][joint].as_slice());
            let weight = sigma[joint].powi(-2);
            for (k, ((r, usable), sum)) in
                series.iter().zip(&usable[joint]).zip(&mut each[1..]).enumerate().take(x.len())
            {
                if !usable {
                    continue;
                }
                let c = [x[k], y[k], z[k]];
                let terms = [
                    c[0] * c[0],
                    c[0] * c[1],
                    c[0] * c[2],
                    c[1] * c[1],
                    c[1] * c[2],
                    c[2] * c[2],
                    c[0] * r,
                    c[1] * r,
                    c[2] * r,
                ];
                for (s, term) in sum.iter_mut().zip(terms) {
                    *s += weight * term;
                }
            }
        }
        for k in 1..each.len() {
            for i in 0..9 {
                each[k][i] += each[k - 1][i];
            }
        }
        Self { sums: each }
    }

    fn rows(&self) -> usize {
        self.sums.len() - 1
    }

    fn between(&self, [start, end]: [usize; 2]) -> [f64; 9] {
        let (first, last) = (&self.sums[start], &self.sums[end.min(self.rows())]);
        std::array::from_fn(|i| last[i] - first[i])
    }

    /// T of a stretch.
    pub(super) fn statistic(&self, span: [usize; 2]) -> f64 {
        let sums = self.between(span);
        let force = solve(&sums);
        (0..3).map(|i| force[i] * sums[6 + i]).sum::<f64>().max(0.0)
    }

    /// The force that explains most of a stretch.
    pub(super) fn force(&self, span: [usize; 2]) -> [f64; 3] {
        solve(&self.between(span))
    }

    /// The deviations of that force: by white noise, which model errors inflate, or where the force changes by that of its mean, A⁻¹ (Σ_p s_p
    /// s_pᵀ) A⁻¹ P/(P − 1) with the scores s_p = g_p − A_p F of P pieces (K.-Y. Liang, S. L. Zeger, *Biometrika* 73, 1986), the larger. A
    /// direction that hardly any joint feels is known as little as it is felt.
    pub(super) fn force_deviation(&self, span: [usize; 2], inflation: f64) -> [f64; 3] {
        let sums = self.between(span);
        let least = ROUNDING * (sums[0] + sums[3] + sums[5]);
        let Some(factor) = normal(&sums, least).cholesky() else { return [f64::INFINITY; 3] };
        let (inverse, force) = (factor.inverse(), Vector3::from(self.force(span)));
        let [start, end] = span;
        let pieces = (end - start).min(BLOCKS);
        let cut = |p: usize| start + (end - start) * p / pieces;
        let score = |p: usize| {
            let own = self.between([cut(p), cut(p + 1)]);
            inverse * (Vector3::new(own[6], own[7], own[8]) - normal(&own, 0.0) * force)
        };
        let changes: Matrix3<f64> = (0..pieces).map(score).map(|s| s * s.transpose()).sum();
        let share = pieces as f64 / (pieces as f64 - 1.0).max(1.0);
        [0, 1, 2].map(|i| (inflation * inverse[(i, i)]).max(share * changes[(i, i)]).sqrt())
    }

    /// By how much the force lowers each joint's whitened sum of squares over a stretch.
    pub(super) fn explained_by_joint(
        &self,
        forces: &ForceColumns,
        residual: &[Vec<f64>],
        usable: &[Vec<bool>],
        sigma: &[f64],
        span: [usize; 2],
    ) -> Vec<f64> {
        let force = self.force(span);
        residual
            .iter()
            .enumerate()
            .map(|(joint, series)| {
                let columns = [0, 1, 2].map(|axis| forces.axes[axis][joint].as_slice());
                if columns[0].is_empty() {
                    return 0.0;
                }
                (span[0]..span[1].min(series.len()))
                    .filter(|k| usable[joint][*k])
                    .map(|k| {
                        let torque: f64 = (0..3).map(|i| force[i] * columns[i][k]).sum();
                        torque * (2.0 * series[k] - torque) / sigma[joint].powi(2)
                    })
                    .sum::<f64>()
                    .max(0.0)
            })
            .collect()
    }
}

/// Solves A F = g. A force along a direction that no joint feels is zero: a small ridge keeps it there.
fn solve(sums: &[f64; 9]) -> [f64; 3] {
    let trace = sums[0] + sums[3] + sums[5];
    if trace <= 0.0 {
        return [0.0; 3];
    }
    let factor = normal(sums, 1e-3 * trace / 3.0).cholesky();
    let force = factor.map(|factor| factor.solve(&Vector3::new(sums[6], sums[7], sums[8])));
    force.map_or([0.0; 3], Into::into)
}

/// A with a ridge.
fn normal(sums: &[f64; 9], ridge: f64) -> Matrix3<f64> {
    let [xx, xy, xz, yy, yz, zz, ..] = *sums;
    Matrix3::new(xx + ridge, xy, xz, xy, yy + ridge, yz, xz, yz, zz + ridge)
}

/// The statistic of every stretch of a length, in steps of an eighth of it.
pub(super) fn scan(prefix: &Prefix, length: usize) -> Vec<Stretch> {
    if length > prefix.rows() {
        return Vec::new();
    }
    (0..=prefix.rows() - length)
        .step_by((length / 8).max(1))
        .map(|start| Stretch {
            statistic: prefix.statistic([start, start + length]),
            start,
            end: start + length,
        })
        .collect()
}

/// How much larger than under white noise the statistic usually is, by length of the stretch.
#[derive(Debug, Clone)]
pub(super) struct Background {
    inflation: Vec<f64>,
}

/// Median of a χ² variable of three degrees of freedom.
const MEDIAN: f64 = 2.366;

impl Background {
    pub(super) fn new(inflation: Vec<f64>) -> Self {
        Self { inflation }
    }

    /// The inflation of some stretches: their median over that under white noise, at least 1. Stretches in which
    /// nothing is usable do not count.
    pub(super) fn inflation(mut values: Vec<f64>) -> f64 {
        values.retain(|s| *s > 0.0);
        if values.is_empty() {
            return f64::INFINITY;
        }
        let middle = values.len() / 2;
        (*values.select_nth_unstable_by(middle, f64::total_cmp).1 / MEDIAN).max(1.0)
    }

    /// The inflation of the n-th length.
    pub(super) fn of_length(&self, which: usize) -> f64 {
        self.inflation[which]
    }

    /// The inflation at any length, interpolated in its logarithm.
    pub(super) fn at(&self, lengths_s: &[f64], length_s: f64) -> f64 {
        let last = lengths_s.len() - 1;
        let after = lengths_s.partition_point(|l| *l < length_s).clamp(1, last);
        let (a, b) = (lengths_s[after - 1], lengths_s[after]);
        let share = ((length_s / a).ln() / (b / a).ln()).clamp(0.0, 1.0);
        let (low, high) = (self.inflation[after - 1], self.inflation[after]);
        if high.is_infinite() { low } else { low + share * (high - low) }
    }
}
