use aurt_traits::{BaseParameters, Motion, RegressorTile, RigidBodyRegressor};
use nalgebra::{DMatrix, DVector};

use crate::RbdError;
use crate::random::Uniform;

/// Motions of the dummy observations: position, velocity and acceleration are uniform within ± these.
const REACH: [f64; 3] = [std::f64::consts::PI, 3.0, 10.0];
/// What remains of a column of unit length after its projection on the kept ones counts as zero below this.
/// Dependent columns leave 1e-13 at most on arms of twelve joints, independent ones 1e-4 at least.
const NUMERICAL_ZERO: f64 = 1e-9;
/// Factors of a linear combination below this are rounding.
const DUST: f64 = 1e-9;
/// The rank counts as settled when this many rounds in a row have found the same columns.
const SETTLED_ROUNDS: usize = 3;
/// Rounds after which an unsettled rank is given up.
const MOST_ROUNDS: usize = 12;

/// The base inertial parameters of a robot, by the two-step numerical procedure of the paper (section
/// III-A.1; Gautier, *Numerical calculation of the base inertial parameters of robots*, J. Robotic Systems
/// 8(4), 1991).
///
/// Step 1: a dummy observation matrix of random motions grows until its rank no longer does. Step 2: its
/// columns, scaled to unit length, are orthogonalised from left to right; a column is independent if its
/// diagonal element of R is not numerically zero, and else its linear combination of the kept columns
/// follows from R₁⁻¹R₂. Of a set of dependent parameters the first in the order of
/// [`RigidBodyRegressor::standard_parameters`] is kept, and the others are added to it. Where the first are dependent but for
/// little (joints that follow one another), those with the largest diagonal elements are kept.
///
/// The result is checked on motions of another seed: Y_base · values(π) = Y π.
///
/// # Errors
/// [`RbdError::BaseParameters`] if the rank does not settle or the check fails: the geometry then has axes
/// that are almost, but not quite, parallel or perpendicular.
pub fn base_parameters(body: &dyn RigidBodyRegressor, seed: u64) -> Result<BaseParameters, RbdError> {
    let mut samples = (2 * body.standard_parameters().len()).div_ceil(body.joints()).max(16);
    let mut settled = 1;
    let mut last = independent_columns(&observe(body, seed, samples)?);
    for round in 1..=MOST_ROUNDS {
        samples += samples / 2;
        let next = independent_columns(&observe(body, seed.wrapping_add(round as u64), samples)?);
        // Which columns have the largest remainders depends on the motions; their number does not.
        let same = next.columns.len() == last.columns.len() && (next.pivoted || next.columns == last.columns);
        settled = if same { settled + 1 } else { 1 };
        last = next;
        if settled == SETTLED_ROUNDS {
            let base = BaseParameters {
                columns: last.columns,
                combinations: last.combinations,
                seed,
                observations: samples,
            };
            check(body, &base, seed)?;
            return Ok(base);
        }
    }
    Err(RbdError::BaseParameters {
        reason: format!(
            "their number did not settle within {MOST_ROUNDS} rounds of {samples} random motions"
        ),
    })
}

/// What a machine is in the base parameters of another description of it.
#[derive(Debug, Clone, PartialEq)]
pub struct CarriedOver {
    /// The values of the base parameters.
    pub values: Vec<f64>,
    /// Of each joint the root mean square of the torque that they leave, over that of its torque: rounding where both
    /// descriptions are of one chain, however their link frames lie.
    pub left: Vec<f64>,
}

/// The values of a robot's base parameters with which it has the torques of `other` rigid bodies of the standard parameters
/// `standard`, by least squares over random motions: min ‖Y_base β − Y_other π‖.
///
/// # Errors
/// [`RbdError::Count`] for another number of joints or parameters, [`RbdError::BaseParameters`] where columns are dependent.
pub fn carry_over(
    body: &dyn RigidBodyRegressor,
    base: &BaseParameters,
    other: &dyn RigidBodyRegressor,
    standard: &[f64],
) -> Result<CarriedOver, RbdError> {
    let (joints, samples) = (body.joints(), base.observations);
    let count = |what, expected, found| {
        if expected == found { Ok(()) } else { Err(RbdError::Count { what, expected, found }) }
    };
    count("joints", joints, other.joints())?;
    count("standard parameters", other.standard_parameters().len(), standard.len())?;
    let own = observe(body, base.seed, samples)?;
    let others = observe(other, base.seed, samples)?;
    let torque = DVector::from_fn(joints * samples, |row, _| {
        others.columns.iter().zip(standard).map(|(column, value)| column[row] * value).sum::<f64>()
    });
    let kept: Vec<&Vec<f64>> = base.columns.iter().map(|c| &own.columns[*c]).collect();
    let lengths: Vec<f64> = kept.iter().map(|column| dot(column, column).sqrt()).collect();
    let columns = DMatrix::from_fn(joints * samples, base.len(), |row, k| kept[k][row] / lengths[k]);
    let qr = columns.clone().qr();
    let scaled = qr.r().solve_upper_triangular(&(qr.q().transpose() * &torque));
    let dependent = || RbdError::BaseParameters { reason: "their columns depend on one another".into() };
    let scaled = scaled.ok_or_else(dependent)?;
    let rest = &torque - columns * &scaled;
    let length = |of: &DVector<f64>, j: usize| of.rows(j * samples, samples).norm();
    Ok(CarriedOver {
        values: scaled.iter().zip(&lengths).map(|(value, length)| value / length).collect(),
        left: (0..joints)
            .map(|j| (length(&torque, j), length(&rest, j)))
            .map(|(whole, left)| if whole > 0.0 { left / whole } else { 0.0 })
            .collect(),
    })
}

/// An observation matrix: one column per standard parameter, rows joint by joint.
struct Observations {
    columns: Vec<Vec<f64>>,
}

fn observe(body: &dyn RigidBodyRegressor, seed: u64, samples: usize) -> Result<Observations, RbdError> {
    let joints = body.joints();
    let parameters = body.standard_parameters().len();
    let mut random = Uniform::from_seed(seed);
    let mut series = REACH.map(|reach| (0..joints * samples).map(|_| random.within(reach)).collect());
    let [q, qd, qdd] = series.each_mut().map(std::mem::take);
    let mut columns = vec![vec![0.0; joints * samples]; parameters];
    let motion = Motion::new(joints, vec![0.0; samples], q, qd, qdd)
        .map_err(|error| RbdError::BaseParameters { reason: error.to_string() })?;
    let mut data = vec![0.0; joints * parameters * samples];
    let destination: Vec<u32> = (0..joints * parameters).map(|d| d as u32).collect();
    let mut tile = RegressorTile::new(&destination, parameters, samples, samples, &mut data);
    body.evaluate(motion.view(), &mut tile);
    for (parameter, column) in columns.iter_mut().enumerate() {
        for (joint, rows) in column.chunks_exact_mut(samples).enumerate() {
            let start = (joint * parameters + parameter) * samples;
            rows.copy_from_slice(&data[start..start + samples]);
        }
    }
    Ok(Observations { columns })
}

struct Selection {
    columns: Vec<usize>,
    combinations: Vec<Vec<(usize, f64)>>,
    /// What the column that is kept with the least has of its unit length.
    smallest: f64,
    /// Whether the columns are those of the largest remainders.
    pivoted: bool,
}

/// Step 2: the first columns that are independent, where these determine the others; else those of the largest remainders.
fn independent_columns(observations: &Observations) -> Selection {
    let all: Vec<usize> = (0..observations.columns.len()).collect();
    let first = eliminated(observations, &all);
    // What is kept with a remainder δ has a direction known to ε/δ, which is what later columns may then leave by rounding.
    // Fingers that follow one another have such columns.
    if first.smallest * NUMERICAL_ZERO >= f64::EPSILON {
        return first;
    }
    let kept = of_largest_remainders(observations);
    let others = all.into_iter().filter(|index| !kept.contains(index));
    let order: Vec<usize> = kept.iter().copied().chain(others).collect();
    Selection { pivoted: true, ..eliminated(observations, &order) }
}

/// Columns with the largest remainder beside those before, as many as are independent, in ascending order.
fn of_largest_remainders(observations: &Observations) -> Vec<usize> {
    let longest = observations.columns.iter().map(|c| dot(c, c).sqrt()).fold(0.0, f64::max);
    let scaled = observations.columns.iter().enumerate().filter_map(|(index, column)| {
        let length = dot(column, column).sqrt();
        let unit = || column.iter().map(|v| v / length).collect::<Vec<f64>>();
        (length > NUMERICAL_ZERO * longest).then(|| (index, unit()))
    });
    let mut open: Vec<(usize, Vec<f64>)> = scaled.collect();
    let mut kept = Vec::new();
    loop {
        let remainders = open.iter().map(|(_, rest)| dot(rest, rest)).enumerate();
        let Some((at, square)) = remainders.max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
        if square.sqrt() <= NUMERICAL_ZERO {
            break;
        }
        let (index, direction) = open.swap_remove(at);
        kept.push(index);
        for (_, rest) in &mut open {
            let share = dot(&direction, rest) / square;
            rest.iter_mut().zip(&direction).for_each(|(v, d)| *v -= share * d);
        }
    }
    kept.sort_unstable();
    kept
}

fn eliminated(observations: &Observations, order: &[usize]) -> Selection {
    let order = order.iter().copied();
    let done = eliminate(&observations.columns, order, NUMERICAL_ZERO, NUMERICAL_ZERO);
    let smallest = done.triangle.iter().filter_map(|r| r.last()).fold(f64::INFINITY, |m, d| m.min(*d));
    let mut combinations: Vec<Vec<(usize, f64)>> = done.kept.iter().map(|k| vec![(*k, 1.0)]).collect();
    for (index, factors) in &done.dependent {
        for (k, factor) in factors.iter().enumerate() {
            let factor = without_dust(factor * done.lengths[*index] / done.lengths[done.kept[k]]);
            if factor != 0.0 {
                combinations[k].push((*index, factor));
            }
        }
    }
    Selection { columns: done.kept, combinations, smallest, pivoted: false }
}

/// Columns of a matrix, told apart into independent ones and combinations of these.
#[derive(Debug, Clone)]
pub struct Elimination {
    /// Lengths of all columns.
    pub lengths: Vec<f64>,
    /// Independent columns, in the order in which they were taken.
    pub kept: Vec<usize>,
    /// Triangle R of the kept columns of unit length, by columns.
    pub triangle: Vec<Vec<f64>>,
    /// Dependent columns of unit length, each with its factors of the kept ones that were taken before it.
    pub dependent: Vec<(usize, Vec<f64>)>,
}

/// QR decomposition column by column in an order, in which dependent columns are left out of Q.
///
/// Columns are scaled to unit length; those shorter than `silent` times the longest are in neither list, those of which
/// less than `zero` is left beside the kept ones are dependent.
pub fn eliminate(
    columns: &[Vec<f64>],
    order: impl IntoIterator<Item = usize>,
    silent: f64,
    zero: f64,
) -> Elimination {
    let lengths: Vec<f64> = columns.iter().map(|c| dot(c, c).sqrt()).collect();
    let longest = lengths.iter().copied().fold(0.0, f64::max);
    let mut done = Elimination { lengths, kept: Vec::new(), triangle: Vec::new(), dependent: Vec::new() };
    let mut q: Vec<Vec<f64>> = Vec::new();
    for index in order {
        let length = done.lengths[index];
        if length <= silent * longest {
            continue;
        }
        let mut rest: Vec<f64> = columns[index].iter().map(|v| v / length).collect();
        let mut r = vec![0.0; q.len()];
        // Projecting twice makes Q orthogonal to rounding, however close the columns are.
        for _ in 0..2 {
            for (direction, r) in q.iter().zip(&mut r) {
                let share = dot(direction, &rest);
                *r += share;
                rest.iter_mut().zip(direction).for_each(|(v, d)| *v -= share * d);
            }
        }
        let diagonal = dot(&rest, &rest).sqrt();
        if diagonal > zero {
            rest.iter_mut().for_each(|v| *v /= diagonal);
            q.push(rest);
            r.push(diagonal);
            done.triangle.push(r);
            done.kept.push(index);
        } else {
            let factors = done.solve(r);
            done.dependent.push((index, factors));
        }
    }
    done
}

impl Elimination {
    /// x with R x = b, for the first columns of R if b is shorter.
    pub fn solve(&self, mut b: Vec<f64>) -> Vec<f64> {
        for row in (0..b.len()).rev() {
            b[row] /= self.triangle[row][row];
            for above in 0..row {
                b[above] -= self.triangle[row][above] * b[row];
            }
        }
        b
    }
}

/// A factor with its rounding removed where it is almost an integer, which the usual ones (0, 1, −1, 2) are.
fn without_dust(factor: f64) -> f64 {
    if (factor - factor.round()).abs() < DUST { factor.round() } else { factor }
}

/// Whether kept columns and combinations give the whole torque on motions of another seed.
fn check(body: &dyn RigidBodyRegressor, base: &BaseParameters, seed: u64) -> Result<(), RbdError> {
    let observations = observe(body, !seed, 64)?;
    let mut random = Uniform::from_seed(seed ^ 0x5555_5555);
    let standard: Vec<f64> = observations.columns.iter().map(|_| random.within(1.0)).collect();
    let values = base.values(&standard);
    let rows = observations.columns.first().map_or(0, Vec::len);
    let sum = |row: usize, terms: &mut dyn Iterator<Item = (usize, f64)>| -> f64 {
        terms.map(|(column, value)| observations.columns[column][row] * value).sum()
    };
    let (mut difference, mut size) = (0.0_f64, 0.0_f64);
    for row in 0..rows {
        let full = sum(row, &mut standard.iter().copied().enumerate());
        let reduced = sum(row, &mut base.columns.iter().copied().zip(values.iter().copied()));
        difference = difference.max((full - reduced).abs());
        size = size.max(full.abs());
    }
    if difference <= 1e-7 * size {
        return Ok(());
    }
    Err(RbdError::BaseParameters {
        reason: format!(
            "{} of them explain other motions only to {:.1e}; \
             write angles that are meant to be exact as expressions (pi/2)",
            base.len(),
            difference / size
        ),
    })
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
