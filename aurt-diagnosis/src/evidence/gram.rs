use aurt_calibration::add_gram;
use rayon::prelude::*;

use crate::recordings::partition::{Part, Partition};
use crate::recordings::rows::{RecordingRows, Role};

/// Second moments of one joint's rows over one part of the data: XᵀX, Xᵀy, yᵀy.
#[derive(Debug, Clone)]
pub struct Moments {
    /// Number of columns.
    pub columns: usize,
    /// XᵀX, column-major.
    pub gram: Vec<f64>,
    /// Xᵀy.
    pub right: Vec<f64>,
    /// yᵀy.
    pub square: f64,
    /// Number of rows.
    pub rows: f64,
}

impl Moments {
    fn zero(columns: usize) -> Self {
        Self {
            columns,
            gram: vec![0.0; columns * columns],
            right: vec![0.0; columns],
            square: 0.0,
            rows: 0.0,
        }
    }

    /// Takes the moments `factor` times.
    pub(crate) fn scale(&mut self, factor: f64) {
        self.gram.iter_mut().chain(&mut self.right).for_each(|value| *value *= factor);
        self.square *= factor;
        self.rows *= factor;
    }

    /// Adds other moments, `sign` times.
    pub(crate) fn add(&mut self, other: &Self, sign: f64) {
        for (a, b) in self.gram.iter_mut().zip(&other.gram) {
            *a += sign * b;
        }
        for (a, b) in self.right.iter_mut().zip(&other.right) {
            *a += sign * b;
        }
        self.square += sign * other.square;
        self.rows += sign * other.rows;
    }
}

/// Moments of every joint by block and by kind of recording (calibration or target).
#[derive(Debug, Clone)]
pub struct BlockMoments {
    /// `[block][kind][joint]`, kind 0 calibration, 1 target.
    pub parts: Vec<[Vec<Moments>; 2]>,
    /// Sum over blocks, `[kind][joint]`.
    pub total: [Vec<Moments>; 2],
}

impl BlockMoments {
    /// Accumulates the moments of `recordings` over the blocks of `partition`.
    pub fn accumulate(recordings: &[RecordingRows], partition: &Partition) -> Self {
        let joints = recordings.first().map_or(0, |r| r.joints.len());
        let columns = |j: usize| {
            recordings.first().map_or(0, |r| {
                let rows = r.joints[j].measurement.len();
                r.joints[j].data.len().checked_div(rows).unwrap_or(0)
            })
        };
        let parts: Vec<[Vec<Moments>; 2]> = partition
            .blocks
            .par_iter()
            .map(|block| {
                let mut part: [Vec<Moments>; 2] =
                    [0, 1].map(|_| (0..joints).map(|j| Moments::zero(columns(j))).collect());
                for (r, start, end) in block {
                    let recording = &recordings[*r];
                    let kind = usize::from(recording.role == Role::Target);
                    for (joint, moments) in recording.joints.iter().zip(&mut part[kind]) {
                        add_rows(moments, &joint.data, &joint.measurement, *start, *end);
                        moments.rows += joint.counted(*start, *end);
                    }
                }
                part
            })
            .collect();
        let mut total: [Vec<Moments>; 2] =
            [0, 1].map(|_| (0..joints).map(|j| Moments::zero(columns(j))).collect());
        for part in &parts {
            for (sum, moments) in total.iter_mut().flatten().zip(part.iter().flatten()) {
                sum.add(moments, 1.0);
            }
        }
        Self { parts, total }
    }

    /// Moments of everything but one block.
    pub fn without(&self, block: usize) -> [Vec<Moments>; 2] {
        let mut rest = self.total.clone();
        for (sum, moments) in rest.iter_mut().flatten().zip(self.parts[block].iter().flatten()) {
            sum.add(moments, -1.0);
        }
        rest
    }

    /// Takes Xᵀy and yᵀy of some joints anew from their rows, in every block and in the sums; XᵀX stays.
    pub fn measure(&mut self, recordings: &[RecordingRows], partition: &Partition, joints: &[usize]) {
        for joint in joints {
            for moments in self.total.iter_mut() {
                moments[*joint].right.fill(0.0);
                moments[*joint].square = 0.0;
            }
            for (block, part) in partition.blocks.iter().zip(&mut self.parts) {
                for (kind, moments) in part.iter_mut().enumerate() {
                    let moments = &mut moments[*joint];
                    moments.right.fill(0.0);
                    moments.square = 0.0;
                    for (r, start, end) in block {
                        if usize::from(recordings[*r].role == Role::Target) != kind {
                            continue;
                        }
                        let rows = &recordings[*r].joints[*joint];
                        let y = &rows.measurement[*start..*end];
                        for (k, sum) in moments.right.iter_mut().enumerate() {
                            *sum += dot(&rows.column(k)[*start..*end], y);
                        }
                        moments.square += dot(y, y);
                    }
                    let total = &mut self.total[kind][*joint];
                    total.right.iter_mut().zip(&moments.right).for_each(|(sum, own)| *sum += own);
                    total.square += moments.square;
                }
            }
        }
    }

    /// Takes the moments of some columns of a joint anew from its rows, in every block and in the sums.
    pub fn renew(
        &mut self,
        recordings: &[RecordingRows],
        partition: &Partition,
        joint: usize,
        columns: &[usize],
    ) {
        for (block, part) in partition.blocks.iter().zip(&mut self.parts) {
            for (kind, moments) in part.iter_mut().enumerate() {
                let moments = &mut moments[joint];
                let all: Vec<usize> = (0..moments.columns).collect();
                let of_kind = |(r, _, _): &&Part| usize::from(recordings[*r].role == Role::Target) == kind;
                let parts: Vec<Part> = block.iter().filter(of_kind).copied().collect();
                moments.renew(recordings, &parts, joint, columns, &all);
            }
        }
        for kind in 0..2 {
            let n = self.total[kind][joint].columns;
            for k in columns {
                for c in 0..n {
                    let sum: f64 = self.parts.iter().map(|p| p[kind][joint].gram[k * n + c]).sum();
                    self.total[kind][joint].gram[k * n + c] = sum;
                    self.total[kind][joint].gram[c * n + k] = sum;
                }
                self.total[kind][joint].right[*k] = self.parts.iter().map(|p| p[kind][joint].right[*k]).sum();
            }
        }
    }
}

impl Moments {
    /// Takes the products of some columns with `others`, with themselves and with the measurement anew.
    pub(crate) fn renew(
        &mut self,
        recordings: &[RecordingRows],
        parts: &[Part],
        joint: usize,
        columns: &[usize],
        others: &[usize],
    ) {
        let n = self.columns;
        for k in columns {
            let product = |other: Option<usize>| -> f64 {
                parts
                    .iter()
                    .map(|(r, start, end)| {
                        let joint = &recordings[*r].joints[joint];
                        let other = other.map_or(joint.measurement.as_slice(), |c| joint.column(c));
                        dot(&joint.column(*k)[*start..*end], &other[*start..*end])
                    })
                    .sum()
            };
            for c in others.iter().chain(columns) {
                let value = product(Some(*c));
                self.gram[k * n + c] = value;
                self.gram[c * n + k] = value;
            }
            self.right[*k] = product(None);
        }
    }
}

/// Products summed in four lanes, which processors do at once.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0; 4];
    let (whole_a, whole_b) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = whole_a.remainder().iter().zip(whole_b.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in whole_a.zip(whole_b) {
        for (lane, (x, y)) in lanes.iter_mut().zip(x.iter().zip(y)) {
            *lane += x * y;
        }
    }
    lanes.iter().sum::<f64>() + rest
}

fn add_rows(moments: &mut Moments, data: &[f64], measurement: &[f64], start: usize, end: usize) {
    let (rows, columns) = (measurement.len(), moments.columns);
    add_gram(data, rows, columns, start..end, &mut moments.gram);
    let y = &measurement[start..end];
    for (k, sum) in moments.right.iter_mut().enumerate() {
        let column = &data[k * rows + start..k * rows + end];
        *sum += column.iter().zip(y).map(|(a, b)| a * b).sum::<f64>();
    }
    moments.square += y.iter().map(|v| v * v).sum::<f64>();
}
