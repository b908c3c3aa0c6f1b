//! Bodies as they are known, or guessed, before any recording.

use aurt_traits::{ColumnGroup, MeasurementUnit, RobotModel};
use nalgebra::Matrix4;
use thiserror::Error;

use crate::physical::{Standard, pseudo_inertia, standard_of};

/// Standard parameters that are known before, from CAD or a URDF.
#[derive(Debug, Clone, PartialEq)]
pub struct Prior {
    /// All standard parameters, in the order of
    /// [`RigidBodyRegressor::standard_parameters`](aurt_traits::RigidBodyRegressor::standard_parameters).
    pub standard: Vec<f64>,
    /// Strength of the pull towards them, in squared standard deviations for each unit of the pull: 1/σ², where σ is the relative
    /// standard deviation of masses and of second moments about the centre of mass. With zero the prior only decides what the data
    /// leave open.
    pub weight: f64,
}

/// Why a prior cannot be used.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages name the fields")]
pub enum PriorError {
    #[error(
        "the prior has {found} standard parameters, but the robot has {expected}; provide ten for each link, from link 0"
    )]
    Count { expected: usize, found: usize },
    #[error(
        "the prior of link {link} is physically impossible: its pseudo-inertia is not positive definite. Mass and principal \
         moments about the centre of mass must be positive, and no moment may exceed the sum of the others; inertia is about \
         the origin of the link's frame, XY, XZ and YZ as −∫xy dm"
    )]
    Impossible { link: usize },
    #[error(
        "the prior is in kg, m and kg m^2, but the model is in A; set `torque_constants_nm_per_a` in `[robot]`"
    )]
    Unit,
    #[error("the prior's weight is {weight}, but must not be negative")]
    Weight { weight: f64 },
}

impl Prior {
    /// What a model knows of its bodies.
    pub(crate) fn of(model: &RobotModel, unit: MeasurementUnit) -> Result<Option<Self>, PriorError> {
        let Some(known) = model.known_bodies() else { return Ok(None) };
        if unit != MeasurementUnit::NewtonMetre {
            return Err(PriorError::Unit);
        }
        Ok(Some(Self { standard: known.standard.clone(), weight: known.weight }))
    }

    /// The links' pseudo-inertias.
    pub(crate) fn bodies(&self, model: &RobotModel) -> Result<Vec<Matrix4<f64>>, PriorError> {
        let body = model.rigid_body();
        let expected = body.standard_parameters().len();
        if self.standard.len() != expected {
            return Err(PriorError::Count { expected, found: self.standard.len() });
        }
        if !self.weight.is_finite() || self.weight < 0.0 {
            return Err(PriorError::Weight { weight: self.weight });
        }
        let links = body.bodies().into_iter().enumerate();
        links
            .map(|(link, indices)| {
                let p = pseudo_inertia(&indices.map(|i| self.standard[i]));
                let possible = p.iter().all(|v| v.is_finite()) && p.cholesky().is_some();
                possible.then_some(p).ok_or(PriorError::Impossible { link })
            })
            .collect()
    }
}

/// Links whose joint turns and has a rotor of which neither a description of bodies nor the model's terms have a word: its
/// inertia is part of the link in the data, as far as these determine it.
pub(super) fn rotors_of_links(model: &RobotModel) -> Vec<usize> {
    let body = model.rigid_body();
    let own = rotor_columns(model);
    let has_own = |joint: usize| own.iter().any(|c| model.row_columns(joint).contains(c));
    (0..body.joints().min(body.bodies().len())).filter(|j| !body.slides(*j) && !has_own(*j)).collect()
}

/// The inertias of rotors among the coefficients.
pub(super) fn rotor_columns(model: &RobotModel) -> Vec<usize> {
    let is_motor =
        |group: &ColumnGroup| matches!(group, ColumnGroup::ArmTerm(k) if !model.arm_terms()[*k].is_load());
    let columns = model.groups().iter().filter(|(group, _)| is_motor(group)).flat_map(|(_, c)| c.clone());
    columns.filter(|c| model.parameters()[*c].unit == "kg m^2").collect()
}

/// Without a prior: for every link a ball about the origin of its frame, its size of the order of the arm's links, its mass
/// of the order that the estimated first moments need. It decides only what the data leave open.
pub(super) fn guessed(model: &RobotModel, coefficients: &[f64]) -> Matrix4<f64> {
    const FIRST_MOMENTS: std::ops::Range<usize> = 6..9;
    const MASS: usize = 9;
    let base = model.base();
    let bodies = model.rigid_body().bodies();
    let role = |parameter: usize| bodies.iter().find_map(|b| b.iter().position(|i| *i == parameter));
    let is_moment = |p: usize| role(p).is_some_and(|r| FIRST_MOMENTS.contains(&r));
    // A first moment collects masses times lengths of links.
    let lengths = base.columns.iter().zip(&base.combinations).filter(|(c, _)| is_moment(**c));
    let length = lengths
        .flat_map(|(_, parts)| parts.iter().filter(|(i, _)| role(*i) == Some(MASS)))
        .fold(0.0_f64, |a, (_, f)| a.max(f.abs()));
    let length = if length > 0.0 { length } else { 0.3 };
    let largest = |of: &dyn Fn(usize) -> bool| {
        let own = base.columns.iter().zip(coefficients).filter(|(c, _)| of(**c));
        own.fold(0.0_f64, |a, (_, v)| a.max(v.abs()))
    };
    let moment = largest(&is_moment);
    let inertia = largest(&|p| role(p).is_some_and(|r| r < 6));
    let whole = if moment > 0.0 { moment / length } else { inertia / length.powi(2) };
    let mass = 2.0 * whole / bodies.len().max(1) as f64;
    let mass = if mass.is_finite() && mass > 0.0 { mass } else { 1.0 };
    ball([0.0; 3], length / 3.0, mass)
}

/// The pseudo-inertia of a homogeneous ball.
pub(super) fn ball(centre_m: [f64; 3], radius_m: f64, mass_kg: f64) -> Matrix4<f64> {
    Matrix4::from_fn(|r, c| match (r, c) {
        (3, 3) => mass_kg,
        (3, k) | (k, 3) => mass_kg * centre_m[k],
        (r, c) => {
            mass_kg * (centre_m[r] * centre_m[c] + if r == c { radius_m * radius_m / 5.0 } else { 0.0 })
        }
    })
}

/// Standard parameters of pseudo-inertias in the place of those of the links.
pub(super) fn standard(model: &RobotModel, bodies: &[Matrix4<f64>]) -> Vec<f64> {
    let body = model.rigid_body();
    let mut all = vec![0.0; body.standard_parameters().len()];
    for (indices, p) in body.bodies().iter().zip(bodies) {
        let own: Standard = standard_of(p);
        indices.iter().zip(own.iter()).for_each(|(i, v)| all[*i] = *v);
    }
    all
}
