//! Output error: the closed loop is simulated from its commands and its positions are compared.
//!
//! # Equation
//! θ̂ = argmin Σ ρ((q_sim(θ) − q)/σ) + Σ ((θ − θ₀)/s)², ρ(x) = 2 (√(1 + x²) − 1), with what is known beforehand, θ₀ ± s.
//! ρ bounds what contacts and collisions weigh. Levenberg's method in units of s, projected to the numbers' bounds;
//! sensitivities ∂q_sim/∂θ are those of the branch of dry friction that is taken, with the speed in the Stribeck factor and in
//! the floor's friction held (with it they explode in stick–slip); eight directions in each pass of the simulation.
//!
//! # Deviations
//! Those of the jackknife over blocks of about [`Options::block_s`], for errors that last (`deviations.rs`), and what numbers
//! that are given may be off: with b ± s_b given instead of estimated, θ̂ moves by −H⁻¹ JᵀWJ_b for each, and
//! Σ = Σ_jackknife + H⁻¹ JᵀWJ_b S_b² J_bᵀWJ H⁻¹. A gain is known no better than the masses that it lifts.
//!
//! # Source
//! Gautier, Janot, Vandanjon (2013), *A new closed-loop output error method for parameter identification of robot dynamics*,
//! IEEE TCST.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use aurt_traits::Jet;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::drives::columns::{Column, Selection, columns, given};
use crate::drives::determined::{Undetermined, undetermined};
use crate::drives::deviations::{Stretch, covariance, stretch_s};
use crate::drives::{DriveError, DriveRecording, DrivenArm, LONGEST_STEP_S};

/// Settings of an estimate.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// σ in rad: the encoder's noise where the model is exact, else what the model is expected to miss.
    pub deviation_rad: f64,
    /// Longest step of the integrator in s.
    pub longest_step_s: f64,
    /// Length of the pieces in s, each of which starts where the robot was (multiple shooting); whole recordings without.
    pub piece_s: Option<f64>,
    /// Length of the blocks whose errors count as independent, in s.
    pub block_s: f64,
    /// Steps after which the search ends anyhow.
    pub most_iterations: usize,
    /// A step that lowers the cost by less than this part ends the search.
    pub tolerance: f64,
}

impl Options {
    pub(crate) fn pieces(&self, recordings: &[DriveRecording]) -> Result<Vec<DriveRecording>, DriveError> {
        let pieces: Result<Vec<_>, _> = recordings.iter().map(|r| r.pieces(self.piece_s)).collect();
        Ok(pieces?.into_iter().flatten().collect())
    }
}

impl Default for Options {
    fn default() -> Self {
        Self {
            deviation_rad: 5e-3,
            longest_step_s: LONGEST_STEP_S,
            piece_s: None,
            block_s: 2.0,
            most_iterations: 40,
            tolerance: 2e-4,
        }
    }
}

/// An estimated number.
#[derive(Debug, Clone, PartialEq)]
pub struct EstimatedNumber {
    /// Its key, with the joint unless all joints share it.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// The estimate.
    pub value: f64,
    /// Its standard deviation; zero of a number at one of its bounds.
    pub deviation: f64,
    /// What was known beforehand.
    pub start: f64,
    /// The deviation of that.
    pub start_deviation: f64,
    /// Whether a bound stopped it.
    pub at_bound: bool,
}

/// The result of [`output_error`].
#[derive(Debug, Clone)]
pub struct OutputErrorFit {
    /// The arm with its estimated numbers.
    pub arm: DrivenArm,
    /// The estimated numbers.
    pub numbers: Vec<EstimatedNumber>,
    /// Directions that the recordings leave open.
    pub undetermined: Vec<Undetermined>,
    /// Σ w JᵀJ/σ² of the recordings alone, in units of what was known beforehand of the numbers.
    pub information: DMatrix<f64>,
    /// Rms of q_sim − q in rad, by recording, or piece, and joint.
    pub rms_rad: Vec<Vec<f64>>,
    /// The least sum that was found.
    pub cost: f64,
    /// Steps taken.
    pub iterations: usize,
    /// Passes of the simulation over a recording, each with eight directions.
    pub passes: u64,
    /// Whether the last step lowered the cost by less than the tolerance.
    pub converged: bool,
    /// Time taken, s.
    pub seconds: f64,
}

/// Estimates the selected numbers of `arm` from recordings; what the arm has for them is the start and known beforehand.
///
/// # Errors
/// Parts that do not fit each other, a selection that the arm does not have, a recording that cannot be used, and
/// [`DriveError::Diverged`] at the start.
pub fn output_error(
    arm: &DrivenArm,
    selection: &Selection,
    recordings: &[DriveRecording],
    options: &Options,
) -> Result<OutputErrorFit, DriveError> {
    let mut fit = output_error_from(arm, selection, recordings, options, arm)?;
    fit.widen(selection, recordings, options)?;
    Ok(fit)
}

/// The same, with the search starting at the numbers of `from`, an arm with the same parts, and what is given taken as exact.
///
/// # Errors
/// As [`output_error`].
pub fn output_error_from(
    arm: &DrivenArm,
    selection: &Selection,
    recordings: &[DriveRecording],
    options: &Options,
    from: &DrivenArm,
) -> Result<OutputErrorFit, DriveError> {
    let began = Instant::now();
    arm.validate()?;
    let columns = columns(arm, selection)?;
    for (k, recording) in recordings.iter().enumerate() {
        recording.check(arm.joints.len(), k)?;
    }
    let recordings = &options.pieces(recordings)?[..];
    let problem = Problem::new(arm, &columns, recordings, options);
    let first = from.numbers();
    let start = |c: &Column| c.places.first().and_then(|p| first.get(*p)).map_or(c.start, |n| n.value);
    let mut theta: Vec<f64> = columns.iter().map(|c| start(c).clamp(c.bounds[0], c.bounds[1])).collect();
    let mut at = problem.linearised(&theta)?;
    let mut damping = 1e-2;
    let (mut iterations, mut converged, mut small) = (0, columns.is_empty(), 0);
    while iterations < options.most_iterations && !converged {
        iterations += 1;
        let step = at.step(&columns, &theta, damping);
        let trial: Vec<f64> = theta
            .iter()
            .zip(&step)
            .zip(&columns)
            .map(|((t, s), c)| (t + s).clamp(c.bounds[0], c.bounds[1]))
            .collect();
        let cost = problem.cost(&trial).unwrap_or(f64::INFINITY);
        if cost < at.cost {
            // Near the end derivatives change with the branches of dry friction: two small steps in a row end the search.
            small = if at.cost - cost < options.tolerance * at.cost { small + 1 } else { 0 };
            converged = small >= 2;
            theta = trial;
            at = problem.linearised(&theta)?;
            damping = (damping * 0.2).max(1e-7);
        } else {
            damping *= 6.0;
            converged = damping > 1e6;
        }
    }
    let mut fitted = arm.clone();
    fitted.set_numbers(&problem.numbers(&theta));
    let fixed = at.at_bounds(&columns, &theta);
    let covariance = covariance(&at.curvature(&fixed), &at.stretches, &fixed);
    let deviation = |k: usize| covariance.as_ref().map_or(f64::INFINITY, |c| c[(k, k)].max(0.0).sqrt());
    let numbers = columns.iter().enumerate().map(|(k, c)| EstimatedNumber {
        name: c.name.clone(),
        unit: c.unit.clone(),
        value: theta[k],
        deviation: deviation(k) * c.deviation,
        start: c.start,
        start_deviation: c.deviation,
        at_bound: fixed[k],
    });
    Ok(OutputErrorFit {
        arm: fitted,
        numbers: numbers.collect(),
        undetermined: undetermined(&columns, &at.information, &fixed),
        information: at.information,
        rms_rad: at.rms_rad,
        cost: at.cost,
        iterations,
        passes: problem.passes.into_inner(),
        converged,
        seconds: began.elapsed().as_secs_f64(),
    })
}

impl OutputErrorFit {
    /// Widens the deviations by what numbers that are given may be off.
    ///
    /// # Errors
    /// As [`output_error`].
    pub fn widen(
        &mut self,
        selection: &Selection,
        recordings: &[DriveRecording],
        options: &Options,
    ) -> Result<(), DriveError> {
        let mut columns = columns(&self.arm, selection)?;
        let estimated = columns.len();
        columns.extend(given(&self.arm, selection)?);
        if columns.len() == estimated {
            return Ok(());
        }
        let pieces = options.pieces(recordings)?;
        let problem = Problem::new(&self.arm, &columns, &pieces, options);
        let theta: Vec<f64> = columns.iter().map(|c| c.start).collect();
        let at = problem.linearised(&theta)?;
        self.passes += problem.passes.into_inner();
        let fixed: Vec<bool> = self.numbers.iter().map(|n| n.at_bound).collect();
        let own =
            Linearised { information: at.information.view((0, 0), (estimated, estimated)).into(), ..at };
        let mut of_given: DMatrix<f64> =
            at.information.view((0, estimated), (estimated, columns.len() - estimated)).into();
        (0..estimated).filter(|k| fixed[*k]).for_each(|k| of_given.row_mut(k).fill(0.0));
        let Some(curvature) = own.curvature(&fixed).cholesky() else { return Ok(()) };
        let moves = curvature.solve(&of_given);
        for ((number, column), moves) in self.numbers.iter_mut().zip(&columns).zip(moves.row_iter()) {
            number.deviation = number.deviation.hypot(column.deviation * moves.norm());
        }
        Ok(())
    }
}

pub(crate) struct Problem<'a> {
    pub arm: &'a DrivenArm,
    pub columns: &'a [Column],
    pub recordings: &'a [DriveRecording],
    pub options: &'a Options,
    /// Length of the stretches whose errors count as independent, in s.
    stretch_s: f64,
    passes: AtomicU64,
}

/// The problem about one θ, in units of the columns' deviations.
struct Linearised {
    cost: f64,
    /// Σ w JᵀJ/σ² of the recordings alone.
    information: DMatrix<f64>,
    /// Σ w Jᵀ r/σ² and the pull of what is known beforehand.
    gradient: DVector<f64>,
    stretches: Vec<Stretch>,
    rms_rad: Vec<Vec<f64>>,
}

/// What one recording contributes to [`Linearised`].
struct Part {
    cost: f64,
    stretches: Vec<Stretch>,
    rms_rad: Vec<f64>,
}

/// Derivatives of a rollout's positions by the selected numbers at their values, in units of [`Options::deviation_rad`] for
/// one deviation of what was known beforehand: a row for each number, a column for each joint of every `stride`-th sample.
///
/// # Errors
/// As [`output_error`](crate::drives::output_error).
pub fn slopes(
    arm: &DrivenArm,
    selection: &Selection,
    recording: &DriveRecording,
    options: &Options,
    stride: usize,
) -> Result<DMatrix<f64>, DriveError> {
    recording.check(arm.joints.len(), 0)?;
    let (columns, recordings) = (columns(arm, selection)?, std::slice::from_ref(recording));
    let theta: Vec<f64> = columns.iter().map(|c| c.start).collect();
    let passes = Problem::new(arm, &columns, recordings, options).passes(&theta, 0)?;
    let joints = arm.joints.len();
    let kept: Vec<usize> = (0..passes[0].len()).filter(|at| (at / joints).is_multiple_of(stride)).collect();
    let of = |row: usize, column: usize| passes[row / Jet::LANES][kept[column]].slope[row % Jet::LANES];
    Ok(DMatrix::from_fn(columns.len(), kept.len(), of))
}

impl<'a> Problem<'a> {
    pub(crate) fn new(
        arm: &'a DrivenArm,
        columns: &'a [Column],
        recordings: &'a [DriveRecording],
        options: &'a Options,
    ) -> Self {
        let lasts_s: f64 = recordings.iter().map(|r| r.time_s[r.time_s.len() - 1] - r.time_s[r.first]).sum();
        let stretch_s = stretch_s(lasts_s, options.block_s);
        Self { arm, columns, recordings, options, stretch_s, passes: AtomicU64::new(0) }
    }

    fn numbers(&self, theta: &[f64]) -> Vec<f64> {
        let mut numbers: Vec<f64> = self.arm.numbers().iter().map(|p| p.value).collect();
        for (column, value) in self.columns.iter().zip(theta) {
            column.places.iter().for_each(|p| numbers[*p] = *value);
        }
        numbers
    }

    fn prior(&self, theta: &[f64]) -> f64 {
        self.columns.iter().zip(theta).map(|(c, t)| ((t - c.start) / c.deviation).powi(2)).sum()
    }

    /// Errors q_sim − q in units of σ over a recording, sample by sample and joint by joint; slopes along the columns of `lanes`.
    pub(crate) fn errors(
        &self,
        theta: &[f64],
        recording: usize,
        lanes: std::ops::Range<usize>,
    ) -> Result<Vec<Jet>, DriveError> {
        let mut numbers: Vec<Jet> = self.numbers(theta).into_iter().map(Jet::constant).collect();
        for (lane, column) in self.columns[lanes].iter().enumerate() {
            for place in &column.places {
                numbers[*place].slope[lane] = column.deviation;
            }
        }
        let measured = &self.recordings[recording];
        let mut errors = Vec::with_capacity(measured.time_s.len() * measured.position_rad.len());
        let mut k = measured.first;
        let visit = |q: &[Jet]| {
            let pairs = q.iter().zip(&measured.position_rad);
            errors.extend(pairs.map(|(q, m)| (*q + -m[k]) * (1.0 / self.options.deviation_rad)));
            k += 1;
        };
        self.passes.fetch_add(1, Ordering::Relaxed);
        self.arm
            .simulate(&numbers, measured, self.options.longest_step_s, visit)
            .map_err(|time_s| DriveError::Diverged { recording, time_s })?;
        Ok(errors)
    }

    /// [`Self::errors`] with slopes along all columns, eight in each pass.
    pub(crate) fn passes(&self, theta: &[f64], recording: usize) -> Result<Vec<Vec<Jet>>, DriveError> {
        let columns = self.columns.len();
        let chunks = (0..columns.div_ceil(Jet::LANES).max(1)).into_par_iter().map(|c| c * Jet::LANES);
        chunks.map(|c| self.errors(theta, recording, c..columns.min(c + Jet::LANES))).collect()
    }

    fn cost(&self, theta: &[f64]) -> Result<f64, DriveError> {
        let of = |r: usize| Ok(self.errors(theta, r, 0..0)?.iter().map(|e| loss(e.value).0).sum::<f64>());
        let costs: Result<Vec<f64>, DriveError> =
            (0..self.recordings.len()).into_par_iter().map(of).collect();
        Ok(costs?.iter().sum::<f64>() + self.prior(theta))
    }

    fn linearised(&self, theta: &[f64]) -> Result<Linearised, DriveError> {
        let parts: Result<Vec<Part>, DriveError> =
            (0..self.recordings.len()).into_par_iter().map(|r| self.part(theta, r)).collect();
        let columns = self.columns.len();
        let pull = self.columns.iter().zip(theta).map(|(c, t)| (t - c.start) / c.deviation);
        let mut sum = Linearised {
            cost: self.prior(theta),
            information: DMatrix::zeros(columns, columns),
            gradient: DVector::from_iterator(columns, pull),
            stretches: Vec::new(),
            rms_rad: Vec::new(),
        };
        for part in parts? {
            sum.cost += part.cost;
            for stretch in &part.stretches {
                sum.information += &stretch.information;
                sum.gradient += &stretch.gradient;
            }
            sum.stretches.extend(part.stretches);
            sum.rms_rad.push(part.rms_rad);
        }
        Ok(sum)
    }

    fn part(&self, theta: &[f64], recording: usize) -> Result<Part, DriveError> {
        let columns = self.columns.len();
        let passes = self.passes(theta, recording)?;
        let measured = &self.recordings[recording];
        let joints = measured.position_rad.len();
        let mut part = Part { cost: 0.0, stretches: Vec::new(), rms_rad: vec![0.0; joints] };
        let time_s = &measured.time_s[measured.first..];
        let samples = time_s.len();
        let mut gradient = DVector::zeros(columns);
        let mut next_s = time_s[0] + self.stretch_s;
        // Weighted rows are folded by the block: a product of matrices is faster than one of vectors at a time.
        let mut rows: Vec<f64> = Vec::new();
        for k in 0..samples {
            for j in 0..joints {
                let at = k * joints + j;
                let error = passes[0][at].value;
                let (cost, weight) = loss(error);
                part.cost += cost;
                part.rms_rad[j] += error * error;
                let root = weight.sqrt();
                let first = rows.len();
                for c in 0..columns {
                    rows.push(passes[c / Jet::LANES][at].slope[c % Jet::LANES] * root);
                }
                for c in 0..columns {
                    gradient[c] += rows[first + c] * root * error;
                }
            }
            if time_s[k] >= next_s || k + 1 == samples {
                next_s = time_s[k] + self.stretch_s;
                let matrix = DMatrix::from_column_slice(columns, rows.len() / columns.max(1), &rows);
                let information = &matrix * matrix.transpose();
                part.stretches.push(Stretch { gradient: gradient.clone(), information });
                gradient.fill(0.0);
                rows.clear();
            }
        }
        let scale = self.options.deviation_rad / (samples as f64).sqrt();
        part.rms_rad.iter_mut().for_each(|s| *s = s.sqrt() * scale);
        Ok(part)
    }
}

impl Linearised {
    /// Which numbers stand at a bound against which the cost pushes them.
    fn at_bounds(&self, columns: &[Column], theta: &[f64]) -> Vec<bool> {
        (0..theta.len())
            .map(|k| {
                let [lower, upper] = columns[k].bounds;
                theta[k] <= lower && self.gradient[k] > 0.0 || theta[k] >= upper && self.gradient[k] < 0.0
            })
            .collect()
    }

    /// Half the curvature of the cost, with what is known beforehand; unit rows for `fixed` numbers.
    fn curvature(&self, fixed: &[bool]) -> DMatrix<f64> {
        let mut curvature = self.information.clone();
        for k in 0..fixed.len() {
            curvature[(k, k)] += 1.0;
            if fixed[k] {
                curvature.row_mut(k).fill(0.0);
                curvature.column_mut(k).fill(0.0);
                curvature[(k, k)] = 1.0;
            }
        }
        curvature
    }

    /// Levenberg's step in the numbers' own units.
    fn step(&self, columns: &[Column], theta: &[f64], damping: f64) -> Vec<f64> {
        let fixed = self.at_bounds(columns, theta);
        let mut curvature = self.curvature(&fixed);
        let mut gradient = self.gradient.clone();
        for k in 0..fixed.len() {
            curvature[(k, k)] *= 1.0 + damping;
            if fixed[k] {
                gradient[k] = 0.0;
            }
        }
        let step = curvature.cholesky().map_or_else(|| gradient.clone() * 0.0, |c| c.solve(&gradient));
        step.iter().zip(columns).map(|(s, c)| -s * c.deviation).collect()
    }
}

/// ρ(x) and the weight ρ'(x)/2x.
pub fn loss(x: f64) -> (f64, f64) {
    let root = (1.0 + x * x).sqrt();
    (2.0 * (root - 1.0), 1.0 / root)
}
