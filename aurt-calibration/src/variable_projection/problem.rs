use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use aurt_traits::{ColumnGroup, RobotModel};
use rayon::prelude::*;

use super::owner::{Owner, Variant};
use crate::row_cache::{LoadSeries, Source, Split, SplitColumn};
use crate::system::triangularise;
use crate::{CalibrationError, FitRows, System};

/// Step by which columns are differentiated, as a share of a shape's range.
const DIFFERENCE: f64 = 1e-4;

/// V(θ) over the shapes of all owners, at a fixed load torque and fixed weights.
pub(super) struct Problem<'a> {
    pub(super) model: &'a RobotModel,
    pub(super) rows: &'a FitRows<'a>,
    pub(super) owners: Vec<Owner>,
    acting: &'a [Vec<bool>],
    loads: &'a [LoadSeries],
    weights: Vec<f64>,
    fixed: Vec<SplitColumn>,
    /// Whether a coefficient occurs in the rows of one joint only.
    private: Vec<bool>,
    shared: Vec<usize>,
    evaluations: AtomicUsize,
}

#[derive(Debug, Clone)]
pub(super) struct Point {
    /// Each owner's shapes, as shares of their ranges.
    pub units: Vec<Vec<f64>>,
    /// V.
    pub cost: f64,
    columns: Vec<Arc<Vec<SplitColumn>>>,
    reduced: Vec<Arc<Reduced>>,
}

/// What a joint's rows say of the shared coefficients once its private ones are eliminated.
#[derive(Debug)]
struct Reduced {
    /// Place of each column among the shared ones and those appended to them; the measurement comes last.
    places: Vec<usize>,
    rows: usize,
    data: Vec<f64>,
}

/// The derivative of the model's output by one shape, ∂(W ζ)/∂θ, in the rows of the joints it acts on.
#[derive(Debug, Clone)]
pub(super) struct Sensitivity {
    /// Owner, and which of its shapes.
    pub shape: (usize, usize),
    /// For each joint the column's parts.
    pub rows: Vec<(usize, Split)>,
}

/// The projected problem, linear around a point: V(θ + δ) ≈ ‖g − G δ‖².
#[derive(Debug, Clone)]
pub(super) struct Linearised {
    /// GᵀG, column-major.
    pub gram: Vec<f64>,
    /// Gᵀg.
    pub slope: Vec<f64>,
}

impl<'a> Problem<'a> {
    pub(super) fn new(
        model: &'a RobotModel,
        rows: &'a FitRows<'a>,
        acting: &'a [Vec<bool>],
        loads: &'a [LoadSeries],
        weights: Vec<f64>,
    ) -> Result<Self, CalibrationError> {
        let owners = Owner::all(model);
        let shapeless: Vec<Source<'_>> = model
            .groups()
            .iter()
            .filter(|(group, _)| owners.iter().all(|o| o.group != *group))
            .filter_map(|(group, _)| Source::of(model, *group))
            .collect();
        let fixed = rows.columns(&shapeless, acting, loads)?;
        let n = model.parameters().len();
        let mut occurrences = vec![0; n];
        for joint in 0..model.joints() {
            model.row_columns(joint).iter().for_each(|c| occurrences[*c] += 1);
        }
        let rigid = model.group(ColumnGroup::RigidBody);
        let private: Vec<bool> = (0..n).map(|c| occurrences[c] == 1 && !rigid.contains(&c)).collect();
        let shared = (0..n).filter(|c| !private[*c]).collect();
        Ok(Self {
            model,
            rows,
            owners,
            acting,
            loads,
            weights,
            fixed,
            private,
            shared,
            evaluations: AtomicUsize::new(0),
        })
    }

    /// How often an owner's columns were evaluated.
    pub(super) fn evaluations(&self) -> usize {
        self.evaluations.load(Ordering::Relaxed)
    }

    /// The problem at given shapes of all owners.
    pub(super) fn at(&self, units: Vec<Vec<f64>>) -> Result<Point, CalibrationError> {
        let columns = units
            .par_iter()
            .enumerate()
            .map(|(o, units)| Ok(Arc::new(self.columns(o, units)?)))
            .collect::<Result<Vec<_>, CalibrationError>>()?;
        let reduced: Vec<Arc<Reduced>> =
            (0..self.model.joints()).map(|j| Arc::new(self.reduce(j, &columns, &[]))).collect();
        let cost = self.cost(&reduced);
        Ok(Point { units, cost, columns, reduced })
    }

    pub(super) fn moved(
        &self,
        point: &Point,
        changes: &[(usize, Vec<f64>)],
    ) -> Result<Point, CalibrationError> {
        let fresh = changes
            .par_iter()
            .map(|(o, units)| Ok(Arc::new(self.columns(*o, units)?)))
            .collect::<Result<Vec<_>, CalibrationError>>()?;
        let mut moved = point.clone();
        let mut touched = vec![false; self.model.joints()];
        for ((o, units), columns) in changes.iter().zip(fresh) {
            columns.iter().for_each(|c| touched[c.joint] = true);
            moved.units[*o].clone_from(units);
            moved.columns[*o] = columns;
        }
        for joint in (0..touched.len()).filter(|j| touched[*j]) {
            moved.reduced[joint] = Arc::new(self.reduce(joint, &moved.columns, &[]));
        }
        moved.cost = self.cost(&moved.reduced);
        Ok(moved)
    }

    pub(super) fn model_at(&self, point: &Point) -> Result<RobotModel, CalibrationError> {
        let mut model = self.model.clone();
        for (owner, units) in self.owners.iter().zip(&point.units) {
            let variant: Variant = owner.at(units)?;
            model = variant.put_into(&model, owner.group).map_err(|mut errors| {
                errors.pop().map_or(CalibrationError::NotFinite, CalibrationError::Model)
            })?;
        }
        Ok(model)
    }

    /// The system of a point, with sensitivities as further coefficients.
    pub(super) fn system(&self, point: &Point, appended: &[Sensitivity]) -> System {
        let n = self.model.parameters().len();
        let factors = (0..self.model.joints())
            .map(|joint| self.rows.factor(joint, &self.joint_columns(joint, &point.columns, appended)))
            .collect();
        System::new(n + appended.len(), factors)
    }

    pub(super) fn coefficients(&self, point: &Point) -> Result<Vec<f64>, CalibrationError> {
        Ok(self.system(point, &[]).solve_coefficients(&self.weights)?.0)
    }

    /// The sensitivities of some owners' shapes; `coefficients` are those of the fit at `point`.
    pub(super) fn sensitivities(
        &self,
        point: &Point,
        owners: &[usize],
        coefficients: &[f64],
    ) -> Result<Vec<Sensitivity>, CalibrationError> {
        let shapes: Vec<(usize, usize)> =
            owners.iter().flat_map(|o| (0..self.owners[*o].shapes.len()).map(move |i| (*o, i))).collect();
        shapes
            .into_par_iter()
            .map(|(o, i)| {
                let mut units = point.units[o].clone();
                let step = if units[i] + DIFFERENCE <= 1.0 { DIFFERENCE } else { -DIFFERENCE };
                units[i] += step;
                let beside = self.columns(o, &units)?;
                let mut rows: Vec<(usize, Split)> = Vec::new();
                for (there, here) in beside.iter().zip(&*point.columns[o]) {
                    let scale = coefficients[here.column] / step;
                    if rows.last().is_none_or(|(joint, _)| *joint != here.joint) {
                        rows.push((here.joint, here.split.zero()));
                    }
                    if let Some((_, sum)) = rows.last_mut() {
                        sum.add_difference(scale, &there.split, &here.split);
                    }
                }
                Ok(Sensitivity { shape: (o, i), rows })
            })
            .collect()
    }

    /// The projected problem around a point, for the shapes of `sensitivities`.
    pub(super) fn linearised(&self, point: &Point, sensitivities: &[Sensitivity]) -> Linearised {
        let n = sensitivities.len();
        let mut touched = vec![false; self.model.joints()];
        sensitivities.iter().flat_map(|s| &s.rows).for_each(|(joint, _)| touched[*joint] = true);
        let reduced: Vec<Arc<Reduced>> = (0..touched.len())
            .map(|joint| {
                if touched[joint] {
                    Arc::new(self.reduce(joint, &point.columns, sensitivities))
                } else {
                    Arc::clone(&point.reduced[joint])
                }
            })
            .collect();
        let (rest, rows) = self.eliminate(&reduced, n);
        let dot = |a: usize, b: usize| -> f64 {
            rest[a * rows..(a + 1) * rows]
                .iter()
                .zip(&rest[b * rows..(b + 1) * rows])
                .map(|(x, y)| x * y)
                .sum()
        };
        Linearised {
            gram: (0..n * n).map(|k| dot(k / n, k % n)).collect(),
            slope: (0..n).map(|k| dot(k, n)).collect(),
        }
    }

    fn columns(&self, owner: usize, units: &[f64]) -> Result<Vec<SplitColumn>, CalibrationError> {
        self.evaluations.fetch_add(1, Ordering::Relaxed);
        let Owner { group, .. } = self.owners[owner];
        let variant = self.owners[owner].at(units)?;
        self.rows.columns(&[variant.source(self.model, group)], self.acting, self.loads)
    }

    /// A joint's columns beside the rigid bodies, coefficients ascending, sensitivities last.
    fn joint_columns<'c>(
        &'c self,
        joint: usize,
        owners: &'c [Arc<Vec<SplitColumn>>],
        appended: &'c [Sensitivity],
    ) -> Vec<(usize, &'c Split)> {
        let n = self.model.parameters().len();
        let mut own: Vec<(usize, &Split)> = self
            .fixed
            .iter()
            .chain(owners.iter().flat_map(|columns| columns.iter()))
            .filter(|c| c.joint == joint)
            .map(|c| (c.column, &*c.split))
            .collect();
        own.sort_by_key(|(column, _)| *column);
        for (k, sensitivity) in appended.iter().enumerate() {
            own.extend(sensitivity.rows.iter().filter(|(j, _)| *j == joint).map(|(_, split)| (n + k, split)));
        }
        own
    }

    /// Eliminates a joint's private coefficients.
    fn reduce(&self, joint: usize, owners: &[Arc<Vec<SplitColumn>>], appended: &[Sensitivity]) -> Reduced {
        let factor = self.rows.factor(joint, &self.joint_columns(joint, owners, appended));
        let (triangle, columns) = (factor.triangle(), factor.columns());
        let size = columns.len() + 1;
        let is_private = |c: usize| self.private.get(c).copied().unwrap_or(false);
        let private: Vec<usize> = (0..columns.len()).filter(|k| is_private(columns[*k])).collect();
        let kept: Vec<usize> = (0..columns.len()).filter(|k| !is_private(columns[*k])).collect();
        let order = private.iter().chain(&kept).copied().chain(std::iter::once(size - 1));
        let mut matrix: Vec<f64> = order
            .flat_map(|k| triangle[k * size..(k + 1) * size].iter().map(|v| self.weights[joint] * v))
            .collect();
        let used = triangularise(&mut matrix, size, private.len()).iter().flatten().count();
        let place = |k: &usize| {
            let column = columns[*k];
            let n = self.model.parameters().len();
            if column >= n {
                self.shared.len() + column - n
            } else {
                self.shared.partition_point(|c| *c < column)
            }
        };
        Reduced {
            places: kept.iter().map(place).collect(),
            rows: size - used,
            data: matrix.chunks_exact(size).skip(private.len()).flat_map(|c| c[used..].to_vec()).collect(),
        }
    }

    /// Eliminates the shared coefficients; what is left of `appended` columns and the measurement, and its rows.
    fn eliminate(&self, reduced: &[Arc<Reduced>], appended: usize) -> (Vec<f64>, usize) {
        let rows: usize = reduced.iter().map(|r| r.rows).sum();
        let shared = self.shared.len();
        let mut stacked = vec![0.0; rows * (shared + appended + 1)];
        let mut first = 0;
        for joint in reduced {
            let places = joint.places.iter().copied().chain(std::iter::once(shared + appended));
            for (place, column) in places.zip(joint.data.chunks_exact(joint.rows)) {
                let start = place * rows + first;
                stacked[start..start + joint.rows].copy_from_slice(column);
            }
            first += joint.rows;
        }
        let used = triangularise(&mut stacked, rows, shared).iter().flatten().count();
        let rest = stacked.chunks_exact(rows).skip(shared).flat_map(|c| c[used..].to_vec()).collect();
        (rest, rows - used)
    }

    fn cost(&self, reduced: &[Arc<Reduced>]) -> f64 {
        let (rest, _) = self.eliminate(reduced, 0);
        let cost: f64 = rest.iter().map(|v| v * v).sum();
        if cost.is_finite() { cost } else { f64::INFINITY }
    }
}
