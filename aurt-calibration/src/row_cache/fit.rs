use std::sync::Arc;

use aurt_traits::{Dispatch, RobotModel};
use rayon::prelude::*;

use super::dynamics::{DynamicsColumn, Source, dynamics_rows};
use super::kept::Kept;
use super::rigid::RigidRows;
use super::series::LoadSeries;
use crate::{
    CalibrationError, CalibrationOptions, JointFactor, NamedRecording, Rest, System, TermScopes, dense,
    noise_bandwidth_factor,
};

/// What is left of a column after one projection still holds about 1e-16 of the column's own length along the basis;
/// if less than this share is left, a second projection takes that away.
const REPROJECT_BELOW: f64 = 0.01;

/// A rigid-body column of which less than this share is independent of those before it is taken as dependent.
const ROUNDING: f64 = 1e-14;

/// Recordings to be fitted: for each joint an orthonormal basis of its rigid-body rows, and the measurement's part
/// along and beyond it.
#[derive(Debug)]
pub struct FitRows<'r> {
    pub(super) rigid: &'r RigidRows<'r>,
    pub(super) pieces: Vec<Piece>,
    pub(super) joints: Vec<JointBasis>,
    pub(super) parts: SplitParts,
    /// The [`noise_bandwidth_factor`] of the filter that rows passed.
    bandwidth: f64,
}

/// The split columns of models that do not read the load torque, by joint and model with its configuration.
type SplitParts = Kept<(usize, String), Vec<Arc<Split>>>;

/// A segment of a recording that is fitted.
#[derive(Debug, Clone)]
pub(crate) struct Piece {
    pub recording: usize,
    pub segment: usize,
    /// For each joint the rows that are fitted; all where there is nothing.
    keep: Option<Vec<Vec<usize>>>,
}

/// The rigid-body rows W = Q R of a joint, over all pieces, and its measurement.
#[derive(Debug)]
pub(super) struct JointBasis {
    rows: usize,
    /// Q, column after column.
    basis: Vec<f64>,
    /// R, column-major.
    triangle: Vec<f64>,
    measurement: Arc<Split>,
}

/// A column's part along the rigid-body columns, as coefficients of their basis, and its part beyond them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Split {
    pub along: Vec<f64>,
    pub beyond: Vec<f64>,
}

impl Split {
    pub(crate) fn zero(&self) -> Self {
        Self { along: vec![0.0; self.along.len()], beyond: vec![0.0; self.beyond.len()] }
    }

    /// Adds `scale` · (a − b).
    pub(crate) fn add_difference(&mut self, scale: f64, a: &Self, b: &Self) {
        let add = |sum: &mut [f64], a: &[f64], b: &[f64]| {
            sum.iter_mut().zip(a.iter().zip(b)).for_each(|(s, (a, b))| *s += scale * (a - b));
        };
        add(&mut self.along, &a.along, &b.along);
        add(&mut self.beyond, &a.beyond, &b.beyond);
    }
}

#[derive(Debug, Clone)]
pub(crate) struct SplitColumn {
    /// The joint whose rows these are.
    pub joint: usize,
    /// The coefficient.
    pub column: usize,
    /// Its parts.
    pub split: Arc<Split>,
}

impl<'r> FitRows<'r> {
    /// Readies a selection of recordings, given by their indices, for fitting.
    ///
    /// # Errors
    /// [`CalibrationError::NothingToCalibrateOn`] for an empty selection.
    pub fn new(
        rigid: &'r RigidRows<'r>,
        recordings: &[usize],
        options: &CalibrationOptions,
    ) -> Result<Self, CalibrationError> {
        let pieces: Vec<Piece> = recordings
            .iter()
            .flat_map(|r| {
                let segments = rigid.recordings()[*r].data.segments.len();
                (0..segments).map(|s| Piece::new(rigid, *r, s, options)).collect::<Vec<_>>()
            })
            .collect();
        if pieces.is_empty() {
            return Err(CalibrationError::NothingToCalibrateOn);
        }
        let joints = (0..rigid.joints())
            .into_par_iter()
            .map(|joint| JointBasis::new(rigid, &pieces, joint))
            .collect::<Result<_, _>>()?;
        let bandwidth = pieces.first().map_or(1.0, |p| {
            let segment = rigid.segment(p.recording, p.segment);
            noise_bandwidth_factor(&segment.parallel_filter, segment.decimation)
        });
        Ok(Self { rigid, pieces, joints, parts: SplitParts::default(), bandwidth })
    }

    /// The rows that are shared.
    pub const fn rigid(&self) -> &'r RigidRows<'r> {
        self.rigid
    }

    /// The selected recordings.
    pub fn recordings(&self) -> impl Iterator<Item = &'r NamedRecording> {
        let mut chosen: Vec<usize> = self.pieces.iter().map(|p| p.recording).collect();
        chosen.dedup();
        let all = self.rigid.recordings();
        chosen.into_iter().map(move |r| &all[r])
    }

    pub(crate) fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// By how much the variance of low-frequency estimates exceeds what independent rows would give.
    pub(crate) const fn bandwidth(&self) -> f64 {
        self.bandwidth
    }

    pub(crate) fn rows(&self, joint: usize) -> usize {
        self.joints[joint].rows
    }

    /// The split columns of some sources, in the order of the sources; `loads` holds τ_J of each piece.
    pub(crate) fn columns(
        &self,
        sources: &[Source<'_>],
        acting: &[Vec<bool>],
        loads: &[LoadSeries],
    ) -> Result<Vec<SplitColumn>, CalibrationError> {
        if sources.is_empty() {
            return Ok(Vec::new());
        }
        let evaluate = |(piece, load): (&Piece, &LoadSeries)| {
            dynamics_rows(sources, self.rigid.segment(piece.recording, piece.segment), load)
        };
        let pieces: Vec<Vec<DynamicsColumn>> =
            self.pieces.par_iter().zip(loads).map(evaluate).collect::<Result<_, _>>()?;
        let Some(first) = pieces.first() else { return Ok(Vec::new()) };
        let joined: Vec<(usize, usize, Vec<f64>)> = first
            .iter()
            .enumerate()
            .map(|(k, DynamicsColumn { joint, column, .. })| {
                let mut rows = Vec::with_capacity(self.rows(*joint));
                for ((piece, columns), acting) in self.pieces.iter().zip(&pieces).zip(acting) {
                    let before = rows.len();
                    piece.append(*joint, &columns[k].rows, &mut rows);
                    if !acting[*column] {
                        rows[before..].fill(0.0);
                    }
                }
                (*joint, *column, rows)
            })
            .collect();
        Ok(self.split(joined))
    }

    fn split(&self, columns: Vec<(usize, usize, Vec<f64>)>) -> Vec<SplitColumn> {
        let mut result: Vec<Option<SplitColumn>> = vec![None; columns.len()];
        for (joint, basis) in self.joints.iter().enumerate() {
            let own: Vec<usize> = (0..columns.len()).filter(|k| columns[*k].0 == joint).collect();
            let splits = basis.split(&own.iter().map(|k| &*columns[*k].2).collect::<Vec<_>>());
            for (k, split) in own.into_iter().zip(splits) {
                result[k] = Some(SplitColumn { joint, column: columns[k].1, split });
            }
        }
        result.into_iter().flatten().collect()
    }

    /// The factor of a joint's rows over its rigid-body columns and `columns`, whose coefficients ascend.
    pub(crate) fn factor(&self, joint: usize, columns: &[(usize, &Split)]) -> JointFactor {
        let basis = &self.joints[joint];
        let (n, k) = (self.rigid.columns(joint).len(), columns.len());
        let size = n + k + 1;
        let splits = columns.iter().map(|(_, split)| *split).chain([&*basis.measurement]);
        let mut beyond = JointFactor::new((0..k).collect());
        beyond.push(|c| &columns[c].1.beyond, &basis.measurement.beyond, |_| true);
        let small = beyond.triangle();
        let mut triangle = vec![0.0; size * size];
        for c in 0..n {
            triangle[c * size..c * size + n].copy_from_slice(&basis.triangle[c * n..(c + 1) * n]);
        }
        for (c, split) in splits.enumerate() {
            let start = (n + c) * size;
            triangle[start..start + n].copy_from_slice(&split.along);
            triangle[start + n..start + size].copy_from_slice(&small[c * (k + 1)..(c + 1) * (k + 1)]);
        }
        let all = self.rigid.columns(joint).iter().copied().chain(columns.iter().map(|(c, _)| *c));
        JointFactor::from_triangle(all.collect(), triangle, basis.rows)
    }

    /// The system of a model whose split columns are given.
    pub(crate) fn system(&self, coefficients: usize, columns: &[SplitColumn]) -> System {
        let factors = (0..self.joints.len())
            .map(|joint| {
                let mut own: Vec<(usize, &Split)> =
                    columns.iter().filter(|c| c.joint == joint).map(|c| (c.column, &*c.split)).collect();
                own.sort_by_key(|(column, _)| *column);
                self.factor(joint, &own)
            })
            .collect();
        System::new(coefficients, factors)
    }

    pub(crate) fn acting(&self, model: &RobotModel, scopes: &TermScopes) -> Vec<Vec<bool>> {
        let all = self.rigid.recordings();
        self.pieces.iter().map(|p| scopes.acting(model, &all[p.recording].name)).collect()
    }
}

impl Piece {
    fn new(rigid: &RigidRows<'_>, recording: usize, segment: usize, options: &CalibrationOptions) -> Self {
        let keep = (options.rest == Rest::Exclude).then(|| {
            let data = rigid.segment(recording, segment);
            let motion = data.motion.view();
            let rest = options.rest_velocities(rigid.rigid_body());
            let moves = |joint: usize, row: &usize| {
                motion.velocity_rad_s(joint)[data.sample(*row)].abs() > rest[joint]
            };
            (0..rigid.joints()).map(|j| (0..data.rows()).filter(|row| moves(j, row)).collect()).collect()
        });
        Self { recording, segment, keep }
    }

    pub(super) fn append(&self, joint: usize, rows: &[f64], to: &mut Vec<f64>) {
        match &self.keep {
            None => to.extend_from_slice(rows),
            Some(keep) => to.extend(keep[joint].iter().map(|row| rows[*row])),
        }
    }
}

impl JointBasis {
    fn new(rigid: &RigidRows<'_>, pieces: &[Piece], joint: usize) -> Result<Self, CalibrationError> {
        let mut measured = Vec::new();
        for piece in pieces {
            let segment = rigid.segment(piece.recording, piece.segment);
            let Some(measurement) = &segment.measurement else {
                let file = rigid.recordings()[piece.recording].name.clone().into();
                return Err(CalibrationError::NoMeasurement { file });
            };
            piece.append(joint, &measurement[joint], &mut measured);
        }
        let (rows, n) = (measured.len(), rigid.columns(joint).len());
        let mut basis = Vec::with_capacity(rows * n);
        let mut triangle = vec![0.0; n * n];
        for k in 0..n {
            let first = basis.len();
            for piece in pieces {
                let column = rigid.column(piece.recording, piece.segment, joint, k);
                piece.append(joint, column, &mut basis);
            }
            let (before, column) = basis.split_at_mut(first);
            let length = norm(column);
            // Twice is enough: the second pass leaves nothing but rounding along the columns before.
            for _ in 0..2 {
                let along = project_out(before, rows, column, 1);
                triangle[k * n..k * n + k].iter_mut().zip(&along).for_each(|(r, a)| *r += a);
            }
            let rest = norm(column);
            if rest > ROUNDING * length {
                triangle[k * n + k] = rest;
                column.iter_mut().for_each(|v| *v /= rest);
            } else {
                column.fill(0.0);
            }
        }
        let mut joint = Self { rows, basis, triangle, measurement: Arc::default() };
        joint.measurement = joint.split(&[&measured]).pop().unwrap_or_default();
        Ok(joint)
    }

    pub(super) fn split(&self, columns: &[&[f64]]) -> Vec<Arc<Split>> {
        let (rows, n) = (self.rows, self.triangle.len().isqrt());
        let mut beyond = columns.concat();
        let mut along = project_out(&self.basis, rows, &mut beyond, columns.len());
        for (k, column) in columns.iter().enumerate() {
            let rest = &mut beyond[k * rows..(k + 1) * rows];
            if norm(rest) < REPROJECT_BELOW * norm(column) {
                let more = project_out(&self.basis, rows, rest, 1);
                along[k * n..(k + 1) * n].iter_mut().zip(more).for_each(|(a, m)| *a += m);
            }
        }
        (0..columns.len())
            .map(|k| {
                let along = along[k * n..(k + 1) * n].to_vec();
                Arc::new(Split { along, beyond: beyond[k * rows..(k + 1) * rows].to_vec() })
            })
            .collect()
    }
}

/// C = Qᵀ B, and B − Q C in the place of B.
fn project_out(basis: &[f64], rows: usize, columns: &mut [f64], count: usize) -> Vec<f64> {
    let n = basis.len().checked_div(rows).unwrap_or(0);
    let mut along = vec![0.0; n * count];
    dense::project_out(Dispatch::active(), basis, rows, columns, &mut along);
    along
}

fn norm(column: &[f64]) -> f64 {
    column.iter().map(|v| v * v).sum::<f64>().sqrt()
}
