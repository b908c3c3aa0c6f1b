//! What the numbers of a model stand for of another with more structure.
//!
//! # Equation
//! A model of the structure `kept` is estimated, β, and so is a `full` one. Each structure o in which the two differ is set in the
//! full model as the kept one has it; d_o = q_full − q_(full, o as kept) is what the kept model has to make up for. Of the change
//! β − β_full the structure o has the part
//!
//! Δβ_o = (Jᵀ W J)⁺ Jᵀ W d_o, J = ∂q_kept/∂β,
//!
//! the bias by omitted variables, linear in β, with J halfway from β to β_full, and exact in o. Directions of which recordings say
//! less than was known beforehand are left out of the inverse.
//!
//! # Source
//! Greene (2012), *Econometric Analysis*, section 4.3.2 (bias by omission of variables).

use aurt_traits::Jet;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::drives::columns::{Column, columns, stem};
use crate::drives::output_error::{Problem, loss};
use crate::drives::{DriveError, DriveRecording, DrivenArm, Options, Selection};

/// What a structure contributes to the numbers of a model that lacks it.
#[derive(Debug, Clone, PartialEq)]
pub struct Absorbed {
    /// Key of the structure's numbers, without their joint.
    pub key: String,
    /// The part of the change of every estimated number, by name, in the number's unit.
    pub changes: Vec<(String, f64)>,
}

/// The parts of the changes of the selected numbers of `kept`, an estimate, against `full`, by key in which the two differ.
///
/// # Errors
/// As [`output_error`](crate::drives::output_error); arms with other parts.
pub fn absorbed(
    kept: &DrivenArm,
    selection: &Selection,
    full: &DrivenArm,
    recordings: &[DriveRecording],
    options: &Options,
) -> Result<Vec<Absorbed>, DriveError> {
    let (names, numbers, complete) = (kept.names(), kept.numbers(), full.numbers());
    if names != full.names() {
        let (expected, found) = (full.names().len(), names.len());
        return Err(DriveError::Count { what: "numbers of both arms", expected, found });
    }
    let columns = columns(kept, selection)?;
    let mut groups: Vec<(String, Vec<f64>)> = Vec::new();
    for (place, name) in names.iter().enumerate() {
        let is_kept = columns.iter().any(|c| c.places.contains(&place));
        if is_kept || numbers[place].value == complete[place].value {
            continue;
        }
        let key = stem(name);
        let at = groups.iter().position(|(k, _)| k == key).unwrap_or_else(|| {
            groups.push((key.to_owned(), complete.iter().map(|n| n.value).collect()));
            groups.len() - 1
        });
        groups[at].1[place] = numbers[place].value;
    }
    let pieces = options.pieces(recordings)?;
    let problem = Problem::new(kept, &columns, &pieces, options);
    let between = |c: &Column| 0.5 * (c.start + complete[c.places[0]].value);
    let theta: Vec<f64> = columns.iter().map(between).collect();
    let parts: Result<Vec<_>, DriveError> =
        (0..pieces.len()).into_par_iter().map(|r| part(&problem, &theta, r, full, &groups)).collect();
    let mut information = DMatrix::zeros(columns.len(), columns.len());
    let mut right = DMatrix::zeros(columns.len(), groups.len());
    for (own, pulls) in parts? {
        information += own;
        right += pulls;
    }
    // A number that a bound holds does not change.
    for (k, _) in columns.iter().enumerate().filter(|(_, c)| c.bounds.contains(&c.start)) {
        information.row_mut(k).fill(0.0);
        information.column_mut(k).fill(0.0);
    }
    let eigen = information.symmetric_eigen();
    let mut changes = DMatrix::zeros(columns.len(), groups.len());
    for (k, value) in eigen.eigenvalues.iter().enumerate().filter(|(_, value)| **value >= 1.0) {
        let direction = eigen.eigenvectors.column(k);
        changes += direction * (direction.transpose() * &right) / *value;
    }
    let of = |(g, (key, _)): (usize, &(String, Vec<f64>))| Absorbed {
        key: key.clone(),
        changes: columns
            .iter()
            .enumerate()
            .map(|(k, c)| (c.name.clone(), changes[(k, g)] * c.deviation))
            .collect(),
    };
    Ok(groups.iter().enumerate().map(of).collect())
}

/// JᵀWJ and JᵀW d of a recording, in units of the columns' deviations.
fn part(
    problem: &Problem<'_>,
    theta: &[f64],
    recording: usize,
    full: &DrivenArm,
    groups: &[(String, Vec<f64>)],
) -> Result<(DMatrix<f64>, DMatrix<f64>), DriveError> {
    let (measured, count) = (&problem.recordings[recording], problem.columns.len());
    let passes = problem.passes(theta, recording)?;
    let complete = full.rollout(measured)?;
    let mut without = Vec::new();
    for (_, values) in groups {
        let mut arm = full.clone();
        arm.set_numbers(values);
        without.push(arm.rollout(measured)?);
    }
    let joints = complete.len();
    let mut information = DMatrix::zeros(count, count);
    let mut right = DMatrix::zeros(count, groups.len());
    for (at, error) in passes[0].iter().enumerate() {
        let (k, j) = (at / joints, at % joints);
        let weight = loss(error.value).1;
        let row = DVector::from_fn(count, |c, _| passes[c / Jet::LANES][at].slope[c % Jet::LANES]);
        information.ger(weight, &row, &row, 1.0);
        for (g, other) in without.iter().enumerate() {
            let difference = (complete[j][k] - other[j][k]) / problem.options.deviation_rad;
            right.column_mut(g).axpy(weight * difference, &row, 1.0);
        }
    }
    Ok((information, right))
}
