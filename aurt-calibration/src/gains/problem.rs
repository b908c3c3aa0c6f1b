//! Least squares over coefficients and gains on the joints' triangles.

use nalgebra::{DMatrix, DVector};

use crate::linear::singular_vectors;
use crate::{CalibrationError, JointFactor, System};

/// Steps at most, for each set of weights.
const STEPS: usize = 60;
/// Times that σ_j is taken from the residual anew.
const WEIGHTINGS: usize = 8;
/// σ_j have settled when none changes by more than this, relatively.
const SETTLED: f64 = 1e-6;
/// The sum of squares has when a step takes away no more than this share of it.
const LEAST: f64 = 1e-13;
/// Halvings of a step that leads uphill.
const HALVINGS: usize = 30;
/// A direction of unit columns that is seen less than this, over the one that is seen most, is not seen.
const UNSEEN: f64 = 1e-9;
/// A direction that no row sees moves a gain if its share there is larger.
const MOVES: f64 = 1e-5;

/// ‖y_j − a_j W_j ζ‖² over ζ, of which some are known, and a.
pub(super) struct Problem {
    factors: Vec<JointFactor>,
    known: Vec<Option<f64>>,
    /// The coefficients that are sought.
    pub free: Vec<usize>,
}

/// Coefficients, and values per torque.
#[derive(Debug, Clone)]
pub(super) struct Point {
    pub coefficients: Vec<f64>,
    /// a_j.
    pub inverse: Vec<f64>,
    /// Deviation of each joint's residual.
    pub sigma: Vec<f64>,
}

impl Problem {
    pub fn new(system: &System, known: Vec<Option<f64>>) -> Self {
        let free = (0..known.len()).filter(|k| known[*k].is_none()).collect();
        Self { factors: system.factors().to_vec(), known, free }
    }

    pub fn factors(&self) -> &[JointFactor] {
        &self.factors
    }

    /// W_j ζ in the coordinates of the joint's triangle, one more than its columns.
    fn predicted(&self, joint: usize, coefficients: &[f64]) -> DVector<f64> {
        let (r, columns) = (self.factors[joint].triangle(), self.factors[joint].columns());
        let size = columns.len() + 1;
        let mut sum = DVector::zeros(size);
        for (k, column) in columns.iter().enumerate() {
            for row in 0..=k {
                sum[row] += r[k * size + row] * coefficients[*column];
            }
        }
        sum
    }

    fn measured(&self, joint: usize) -> DVector<f64> {
        let (r, size) = (self.factors[joint].triangle(), self.factors[joint].columns().len() + 1);
        DVector::from_column_slice(&r[(size - 1) * size..size * size])
    }

    fn residual_sums(&self, coefficients: &[f64], inverse: &[f64]) -> Vec<f64> {
        (0..self.factors.len())
            .map(|j| (self.measured(j) - inverse[j] * self.predicted(j, coefficients)).norm_squared())
            .collect()
    }

    /// Σ σ_j⁻² ‖y_j − a_j W_j ζ‖².
    fn cost(&self, coefficients: &[f64], inverse: &[f64], weights: &[f64]) -> f64 {
        self.residual_sums(coefficients, inverse).iter().zip(weights).map(|(s, w)| w * w * s).sum()
    }

    /// σ_j of a fit of so many quantities to each joint's share of the rows.
    fn sigma(&self, sums: &[f64]) -> Result<Vec<f64>, CalibrationError> {
        let parameters = self.free.len() + self.factors.len();
        let sigma: Vec<f64> = self
            .factors
            .iter()
            .zip(sums)
            .map(|(factor, sum)| {
                let rows = factor.rows();
                if rows <= parameters {
                    return Err(CalibrationError::TooFewSamples { rows, parameters });
                }
                Ok((sum / (rows - parameters) as f64).sqrt())
            })
            .collect::<Result<_, _>>()?;
        if sigma.iter().all(|s| s.is_finite()) { Ok(sigma) } else { Err(CalibrationError::NotFinite) }
    }

    /// The solution of g_j y_j = W_j ζ, which is linear in ζ and g and a little too small in g, since y_j is noisy. Without a
    /// known coefficient one gain is 1.
    pub fn start(&self) -> Result<Point, CalibrationError> {
        let joints = self.factors.len();
        let size: Vec<f64> = (0..joints)
            .map(|j| (self.measured(j).norm_squared() / self.factors[j].rows().max(1) as f64).sqrt())
            .collect();
        let weights: Vec<f64> = size.iter().map(|s| if *s > 0.0 { 1.0 / s } else { 0.0 }).collect();
        let is_fixed = |j: usize| self.known.iter().all(Option::is_none) && j == self.loudest();
        let (rows, n) = (self.rows(), self.free.len());
        let (mut matrix, mut right) = (DMatrix::zeros(rows, n + joints), DVector::zeros(rows));
        let mut at = 0;
        for (j, factor) in self.factors.iter().enumerate() {
            let height = factor.columns().len() + 1;
            self.write_columns(j, weights[j], at, &mut matrix);
            let known: Vec<f64> = self.known.iter().map(|k| k.unwrap_or(0.0)).collect();
            right.rows_mut(at, height).copy_from(&(-weights[j] * self.predicted(j, &known)));
            let measured = weights[j] * self.measured(j);
            if is_fixed(j) {
                let sum = right.rows(at, height) + &measured;
                right.rows_mut(at, height).copy_from(&sum);
            } else {
                matrix.view_mut((at, n + j), (height, 1)).copy_from(&(-measured));
            }
            at += height;
        }
        let solution = Directions::of(matrix)?.solve(&right);
        let mut coefficients: Vec<f64> = self.known.iter().map(|k| k.unwrap_or(0.0)).collect();
        self.free.iter().zip(solution.iter()).for_each(|(k, v)| coefficients[*k] = *v);
        let inverse: Vec<f64> = (0..joints)
            .map(|j| {
                let gain = if is_fixed(j) { 1.0 } else { solution[n + j] };
                if gain.is_finite() && gain.abs() > f64::MIN_POSITIVE.sqrt() { 1.0 / gain } else { 1.0 }
            })
            .collect();
        let sigma = self.sigma(&self.residual_sums(&coefficients, &inverse))?;
        Ok(Point { coefficients, inverse, sigma })
    }

    /// The joint whose measurement is the largest.
    fn loudest(&self) -> usize {
        let size = |j: &usize| self.measured(*j).norm_squared();
        (0..self.factors.len()).max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(0)
    }

    fn rows(&self) -> usize {
        self.factors.iter().map(|f| f.columns().len() + 1).sum()
    }

    /// The free columns of joint j, times `factor`, from a row on.
    fn write_columns(&self, joint: usize, factor: f64, at: usize, matrix: &mut DMatrix<f64>) {
        let (r, columns) = (self.factors[joint].triangle(), self.factors[joint].columns());
        for (k, column) in columns.iter().enumerate() {
            if let Ok(place) = self.free.binary_search(column) {
                for row in 0..=k {
                    matrix[(at + row, place)] = factor * r[k * (columns.len() + 1) + row];
                }
            }
        }
    }

    /// The weighted derivative of the prediction by the free coefficients and by log a_j.
    pub fn jacobian(&self, point: &Point, weights: &[f64]) -> DMatrix<f64> {
        let n = self.free.len();
        let mut matrix = DMatrix::zeros(self.rows(), n + self.factors.len());
        let mut at = 0;
        for (j, factor) in self.factors.iter().enumerate() {
            let scale = weights[j] * point.inverse[j];
            self.write_columns(j, scale, at, &mut matrix);
            let own = scale * self.predicted(j, &point.coefficients);
            matrix.view_mut((at, n + j), (own.len(), 1)).copy_from(&own);
            at += factor.columns().len() + 1;
        }
        matrix
    }

    /// The least sum of squares, its weights from its own residuals.
    ///
    /// # Errors
    /// [`CalibrationError::TooFewSamples`], [`CalibrationError::NotFinite`].
    pub fn minimum(&self, start: Point) -> Result<Point, CalibrationError> {
        let mut point = start;
        for _ in 0..WEIGHTINGS {
            let weights = crate::system::weights(&point.sigma);
            let mut cost = self.cost(&point.coefficients, &point.inverse, &weights);
            for _ in 0..STEPS {
                let Some((next, lower)) = self.step(&point, &weights, cost)? else { break };
                let gained = cost - lower;
                (point, cost) = (next, lower);
                if gained <= LEAST * cost {
                    break;
                }
            }
            let sigma = self.sigma(&self.residual_sums(&point.coefficients, &point.inverse))?;
            let change =
                sigma.iter().zip(&point.sigma).map(|(a, b)| (a - b).abs() / a.max(f64::MIN_POSITIVE));
            let has_settled = change.fold(0.0, f64::max) < SETTLED;
            point.sigma = sigma;
            if has_settled {
                break;
            }
        }
        Ok(point)
    }

    /// A point with a lower sum of squares, if a step leads to one.
    fn step(
        &self,
        point: &Point,
        weights: &[f64],
        cost: f64,
    ) -> Result<Option<(Point, f64)>, CalibrationError> {
        let mut left = DVector::zeros(self.rows());
        let mut at = 0;
        for j in 0..self.factors.len() {
            let own =
                weights[j] * (self.measured(j) - point.inverse[j] * self.predicted(j, &point.coefficients));
            left.rows_mut(at, own.len()).copy_from(&own);
            at += own.len();
        }
        let step = Directions::of(self.jacobian(point, weights))?.solve(&left);
        let mut share = 1.0;
        for _ in 0..HALVINGS {
            let mut next = point.clone();
            for (place, k) in self.free.iter().enumerate() {
                next.coefficients[*k] += share * step[place];
            }
            for (j, a) in next.inverse.iter_mut().enumerate() {
                *a *= 1.0 + share * step[self.free.len() + j];
            }
            let lower = self.cost(&next.coefficients, &next.inverse, weights);
            if lower < cost {
                return Ok(Some((next, lower)));
            }
            share /= 2.0;
        }
        Ok(None)
    }
}

/// A matrix by the directions that its rows see, columns scaled to equal length.
struct Directions {
    scale: DVector<f64>,
    left: DMatrix<f64>,
    values: DVector<f64>,
    right: DMatrix<f64>,
}

impl Directions {
    fn of(mut matrix: DMatrix<f64>) -> Result<Self, CalibrationError> {
        if matrix.nrows() < matrix.ncols() {
            matrix = matrix.clone().resize_vertically(matrix.ncols(), 0.0);
        }
        let norm = |c: usize| matrix.column(c).norm();
        let scale = DVector::from_fn(matrix.ncols(), |c, _| if norm(c) > 0.0 { 1.0 / norm(c) } else { 1.0 });
        for (mut column, factor) in matrix.column_iter_mut().zip(scale.iter()) {
            column *= *factor;
        }
        let (left, values, right) = singular_vectors(&matrix).ok_or(CalibrationError::NotFinite)?;
        Ok(Self { scale, left, values, right })
    }

    fn sees(&self, k: usize) -> bool {
        self.values[k] > UNSEEN * self.values.max()
    }

    fn solve(&self, right: &DVector<f64>) -> DVector<f64> {
        let mut sum = DVector::zeros(self.scale.len());
        let padded = right.clone().resize_vertically(self.left.nrows(), 0.0);
        for k in (0..self.values.len()).filter(|k| self.sees(*k)) {
            sum += self.right.column(k) * (self.left.column(k).dot(&padded) / self.values[k]);
        }
        sum.component_mul(&self.scale)
    }
}

/// What the rows see at a point.
pub(super) struct Seen {
    /// (JᵀΩ⁻¹J)⁺ over the free coefficients and log a_j.
    pub inverse: DMatrix<f64>,
    /// Of each direction that no row sees, the shares of log a_j.
    unseen: Vec<Vec<f64>>,
    joints: usize,
    with: usize,
}

impl Seen {
    pub fn at(problem: &Problem, point: &Point) -> Result<Self, CalibrationError> {
        let weights = crate::system::weights(&point.sigma);
        let joints = problem.factors.len();
        let directions = Directions::of(problem.jacobian(point, &weights))?;
        let (size, n) = (directions.scale.len(), problem.free.len());
        let mut inverse = DMatrix::zeros(size, size);
        let mut unseen = Vec::new();
        for k in 0..directions.values.len() {
            let along = directions.right.column(k).component_mul(&directions.scale);
            if directions.sees(k) {
                inverse += &along * along.transpose() / directions.values[k].powi(2);
            } else {
                // In units of the columns, so that a gain that is seen well does not look moved by rounding.
                let own = directions.right.column(k);
                unseen.push(
                    (0..joints).map(|j| if own[n + j].abs() > MOVES { along[n + j] } else { 0.0 }).collect(),
                );
            }
        }
        let mut seen = Self { inverse, unseen, joints, with: 0 };
        // Ratios refer to the joint that shares one with most others.
        let partners = |r: &usize| (0..joints).filter(|j| seen.has_ratio(*j, *r)).count();
        let with = (0..joints).max_by_key(|r| (partners(r), joints - r)).unwrap_or(0);
        seen.with = with;
        Ok(seen)
    }

    /// Whether a joint's gain is determined.
    pub fn decides_gain(&self, joint: usize) -> bool {
        self.unseen.iter().all(|u| u[joint] == 0.0)
    }

    /// Whether the ratio to the gains of most others is.
    pub fn decides_ratio(&self, joint: usize) -> bool {
        self.has_ratio(joint, self.with)
    }

    /// Whether any ratio is determined.
    pub fn has_ratios(&self) -> bool {
        (0..self.joints).filter(|j| self.decides_ratio(*j)).count() > 1
    }

    fn has_ratio(&self, a: usize, b: usize) -> bool {
        let largest = |u: &Vec<f64>| u.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        self.unseen.iter().all(|u| (u[a] - u[b]).abs() <= 1e-4 * largest(u))
    }
}
