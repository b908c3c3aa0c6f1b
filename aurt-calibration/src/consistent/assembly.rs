//! The convex program of a robot: its variables, its bodies, and what of it is positive.

use aurt_traits::{BaseParameters, RobotModel};
use nalgebra::{DMatrix, DVector, Matrix4};

use super::inside::inside;
use super::prior::{ball, rotor_columns, standard};
use super::program::{BodyMap, Positive, Program};
use crate::linear::solve_upper;
use crate::physical::{Standard, braking_rows, carried, standard_of};
use crate::system::Triangle;
use crate::{CalibrationError, CalibrationOptions, JointRange, System};

/// What a consistent estimate starts from.
#[derive(Debug, Clone, Copy)]
pub struct Fit<'a> {
    /// The model.
    pub model: &'a RobotModel,
    /// The rows of all recordings.
    pub system: &'a System,
    /// 1/σ_j.
    pub weights: &'a [f64],
    /// The weighted least-squares coefficients.
    pub coefficients: &'a [f64],
    /// Their covariance, column-major.
    pub covariance: &'a [f64],
    /// By how much the rows' noise exceeds that of independent rows of deviation σ_j.
    pub scale: f64,
    /// What calibration covered.
    pub ranges: &'a [JointRange],
    /// The calibration's settings.
    pub options: &'a CalibrationOptions,
}

/// A program with what its variables y = (v, ξ) mean.
///
/// v are the standard parameters that are not kept as base parameters (w), the bodies' coefficients that the rows do
/// not determine (u), and the rotors that are part of the links (J); ξ = R ζ_kept + B u − z are the rows' own coordinates.
/// The kept standard parameters are π_k = ζ_k − Σ factor w, so that the data and what they leave open are apart exactly,
/// not to rounding.
pub(super) struct Assembly {
    pub program: Program,
    /// A point inside.
    pub start: DVector<f64>,
    /// ζ = Z y + z₀.
    pub coefficients: (DMatrix<f64>, DVector<f64>),
    /// Standard parameters = X y + x₀.
    pub standard: (DMatrix<f64>, DVector<f64>),
    /// Joints whose friction no coefficients make brake everywhere.
    pub undecided: Vec<usize>,
    /// What the program's bodies are; the links come first.
    pub names: Vec<String>,
}

/// The standard parameters of a thin disc about the z axis of a link, of unit inertia and no mass: what the rotor of the
/// link's joint is as a part of the link.
const ROTOR: [f64; 10] = [0.5, 0.0, 0.0, 0.5, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0];
/// The place of ZZ among the standard parameters of a body.
const ABOUT_AXIS: usize = 5;

#[derive(Clone, Copy)]
pub(super) struct Ground<'a> {
    pub fit: &'a Fit<'a>,
    pub triangle: &'a Triangle,
    /// The links' pseudo-inertias in the prior.
    pub prior: &'a [Matrix4<f64>],
    /// That of the links; nothing is known of loads.
    pub pull_weight: f64,
    /// Links whose rotor is neither in the prior nor a term of the model.
    pub rotors: &'a [usize],
}

impl Assembly {
    pub(super) fn new(ground: Ground<'_>) -> Result<Self, CalibrationError> {
        let Ground { fit, triangle, prior, pull_weight, rotors } = ground;
        let Fit { model, scale, .. } = *fit;
        let n = model.parameters().len();
        let base = model.base();
        let m = triangle.kept.len();
        let loads = carried(model);
        let of_body = |c: usize| c < base.len() || loads.iter().any(|b| b.columns.contains(&c));
        let silent: Vec<(usize, usize)> =
            triangle.others.iter().copied().enumerate().filter(|(_, c)| of_body(*c)).collect();
        let all = model.rigid_body().standard_parameters().len();
        let open: Vec<usize> = (0..all).filter(|p| !base.columns.contains(p)).collect();
        let first_rotor = open.len() + silent.len();
        let free = first_rotor + rotors.len();
        let variables = free + m;

        // ζ_kept = R⁻¹ (ξ + z − B u).
        let solve =
            |matrix: &DMatrix<f64>| solve_upper(&triangle.upper, matrix).ok_or(CalibrationError::NotFinite);
        let inverse = solve(&DMatrix::identity(m, m))?;
        let beyond = solve(&triangle.beyond)?;
        let fitted = solve(&DMatrix::from_column_slice(m, 1, triangle.right.as_slice()))?;
        let mut of = DMatrix::zeros(n, variables);
        let mut at = DVector::zeros(n);
        for (a, column) in triangle.kept.iter().enumerate() {
            of.view_mut((*column, free), (1, m)).copy_from(&inverse.row(a));
            for (j, (k, _)) in silent.iter().enumerate() {
                of[(*column, open.len() + j)] = -beyond[(a, *k)];
            }
            at[*column] = fitted[(a, 0)];
        }
        for (j, (_, column)) in silent.iter().enumerate() {
            of[(*column, open.len() + j)] = 1.0;
        }

        let (standard_of_variables, standard_at) = standard_map(base, all, &open, (&of, &at));

        let mut bodies = Vec::new();
        let mut names = Vec::new();
        for (link, (indices, prior)) in model.rigid_body().bodies().iter().zip(prior).enumerate() {
            let mut of = standard_of_variables.select_rows(indices);
            if let Some(r) = rotors.iter().position(|own| *own == link) {
                of.set_column(first_rotor + r, &-Standard::from(ROTOR));
            }
            bodies.push(BodyMap {
                of,
                at: Standard::from_iterator(indices.iter().map(|i| standard_at[*i])),
                prior: *prior,
                pull_weight,
            });
            names.push(format!("link {link}"));
        }
        let mut rows: Vec<Row> = Vec::new();
        let mut begin = at.clone();
        for body in &loads {
            let columns = body.places.map(|p| p.map(|p| body.columns.start + p));
            let Some(mass) = columns[9] else { continue };
            let sign = if at[mass] < 0.0 { -1.0 } else { 1.0 };
            let Some(whole) = columns.iter().copied().collect::<Option<Vec<usize>>>() else {
                rows.push((None, unit(n, mass, sign)));
                begin[mass] = at[mass].abs().max(1e-3) * sign;
                continue;
            };
            let guess = load_guess(&whole, &at, sign, &prior[0]);
            bodies.push(BodyMap {
                of: of.select_rows(&whole) * sign,
                at: Standard::from_iterator(whole.iter().map(|c| sign * at[*c])),
                prior: guess,
                pull_weight: 0.0,
            });
            names.push(format!("load on link {}", body.link));
            whole.iter().zip(standard_of(&guess).iter()).for_each(|(c, v)| begin[*c] = sign * v);
        }
        rows.extend(signed(fit)?);
        let estimated: Vec<bool> = (0..n).map(|c| of.row(c).iter().any(|v| *v != 0.0)).collect();
        let undecided = inside(&mut rows, &estimated, &mut begin);
        let mut positive: Vec<Positive> =
            rows.into_iter().map(|(_, row)| Positive { at: row.dot(&at), of: of.tr_mul(&row) }).collect();
        positive.extend((first_rotor..free).map(|r| Positive { at: 0.0, of: unit(variables, r, 1.0) }));

        let mut guessed = standard(model, prior);
        let mut start = DVector::zeros(variables);
        let links = model.rigid_body().bodies();
        for (r, link) in rotors.iter().enumerate() {
            start[first_rotor + r] = add_rotor(&mut guessed, &links[*link]);
        }
        begin.rows_mut(0, base.len()).copy_from_slice(&base.values(&guessed));
        open.iter().enumerate().for_each(|(w, p)| start[w] = guessed[*p]);
        let mut others = DVector::zeros(triangle.others.len());
        for (j, (k, column)) in silent.iter().enumerate() {
            start[open.len() + j] = begin[*column];
            others[*k] = begin[*column];
        }
        let kept = DVector::from_iterator(m, triangle.kept.iter().map(|c| begin[*c]));
        let seen = &triangle.upper * kept + &triangle.beyond * others - &triangle.right;
        start.rows_mut(free, m).copy_from(&seen);
        Ok(Self {
            program: Program { free, seen: m, scale, bodies, positive },
            start,
            coefficients: (of, at),
            standard: (standard_of_variables, standard_at),
            undecided,
            names,
        })
    }
}

/// The standard parameters, from the coefficients (ζ = Z y + z₀) and those of them that are `open`, which are variables.
fn standard_map(
    base: &BaseParameters,
    all: usize,
    open: &[usize],
    (of, at): (&DMatrix<f64>, &DVector<f64>),
) -> (DMatrix<f64>, DVector<f64>) {
    let mut place_of = vec![None; all];
    let mut standard_of = DMatrix::zeros(all, of.ncols());
    let mut standard_at = DVector::zeros(all);
    for (w, p) in open.iter().enumerate() {
        place_of[*p] = Some(w);
        standard_of[(*p, w)] = 1.0;
    }
    for (k, (column, parts)) in base.columns.iter().zip(&base.combinations).enumerate() {
        standard_of.row_mut(*column).copy_from(&of.row(k));
        standard_at[*column] = at[k];
        for (part, factor) in parts.iter().filter(|(part, _)| part != column) {
            if let Some(w) = place_of[*part] {
                standard_of[(*column, w)] -= factor;
            }
        }
    }
    (standard_of, standard_at)
}

/// A condition on the coefficients, a·ζ > 0, and the joint that it is of.
type Row = (Option<usize>, DVector<f64>);

/// Rotors have positive inertia, and friction brakes.
fn signed(fit: &Fit<'_>) -> Result<Vec<Row>, CalibrationError> {
    let model = fit.model;
    let n = model.parameters().len();
    let mut rows: Vec<Row> = rotor_columns(model).into_iter().map(|c| (None, unit(n, c, 1.0))).collect();
    for joint in 0..model.joints() {
        let rest_velocity = fit.options.rest_velocity(&**model.rigid_body(), joint);
        let braking = braking_rows(model, joint, &fit.ranges[joint], rest_velocity)?;
        rows.extend(braking.into_iter().map(|row| (Some(joint), DVector::from_vec(row))));
    }
    Ok(rows)
}

/// Adds a rotor to a link, of as much inertia as the link has about the axis, which is returned.
fn add_rotor(standard: &mut [f64], link: &[usize; 10]) -> f64 {
    let inertia = standard[link[ABOUT_AXIS]];
    link.iter().zip(ROTOR).for_each(|(p, v)| standard[*p] += inertia * v);
    inertia
}

fn unit(n: usize, at: usize, value: f64) -> DVector<f64> {
    let mut row = DVector::zeros(n);
    row[at] = value;
    row
}

/// A ball at the estimated centre of mass of a load, where it has one.
fn load_guess(columns: &[usize], at: &DVector<f64>, sign: f64, link: &Matrix4<f64>) -> Matrix4<f64> {
    let mass = sign * at[columns[9]];
    if mass <= 0.0 || !mass.is_finite() {
        return *link;
    }
    let centre: [f64; 3] = std::array::from_fn(|k| sign * at[columns[6 + k]] / mass);
    let distance = centre.iter().map(|c| c * c).sum::<f64>().sqrt();
    ball(centre, (0.1 * distance).max(0.05), mass)
}
