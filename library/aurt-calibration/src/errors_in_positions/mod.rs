//! Noise in the positions.
//!
//! The regressor is made from measured positions, and least squares knows only noise of the measurement y: errors ΔW of the
//! regressor pull coefficients towards zero, since E (W + ΔW)ᵀ(W + ΔW) = WᵀW + E ΔWᵀΔW. Adding the noise once more, as the
//! noise model of each joint draws it (white noise, and the lattice of the encoder on the very motion, through the filters of
//! the positions), shows what it does to the normal equations A ζ = c; taking that away once gives them without noise,
//!
//! (2A − E A*) ζ = 2c − E c*,
//!
//! corrected scores by simulation (Nakamura 1990; Novick and Stefanski 2002). Exact where the regressor is linear in the
//! noise; to first order in its power elsewhere. Friction turns with the sign of the velocity, where that is not enough: the
//! correction shows that and where noise matters, and intervals around corrected estimates of friction hold less often than
//! those of least squares (docs/estimation.md). So experiments do not offer it as an estimator. Instead, what the noise added
//! once more does to estimates widens their intervals ([`Shift`]).

mod hausman;
mod noise;
mod shift;

use aurt_recording::{PositionNoise, ZeroPhase};
use aurt_traits::{LoadTorque, RobotModel};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::{
    CalibrationError, CalibrationOptions, NamedRecording, Solution, System, TermScopes, accumulate_scoped,
    random::Random,
};
pub(crate) use hausman::Tested;
pub use hausman::{Hausman, hausman};
use noise::{acceleration_share, noisier};
pub(crate) use shift::Shift;

/// Order of the filter of the positions, one way.
const FILTER_ORDER: usize = 4;
/// Motions lie below this share of the parallel cut-off, which is half of f_dyn, and below this frequency, Hz, as far as
/// the speed with which a joint crosses the lattice is concerned.
const MOTION_SHARE: f64 = 0.25;
const MOTION_HZ: f64 = 3.0;
/// A smaller share of noise in the accelerations is not looked at: it moves coefficients by less than it.
const NEGLIGIBLE_SHARE: f64 = 1e-4;
/// Draws of the noise that a bias is shown from, and that it is corrected by.
pub(crate) const DRAWS: [u64; 2] = [4, 16];
/// Beyond this share of noise in accelerations first order is not enough (docs/estimation.md).
const OVERWHELMING: f64 = 0.5;
/// A bias of so many standard deviations makes intervals an eighth wider.
const NOTABLE: f64 = 0.5;

/// What noise of the positions does to least squares.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PositionBias {
    /// The joints.
    pub joints: Vec<JointPositionNoise>,
    /// Draws of the noise; none where it is negligible.
    pub draws: u64,
    /// The coefficients that the recordings determine; none where noise is negligible.
    pub parameters: Vec<ParameterBias>,
    /// Whether instruments find other coefficients; absent where noise is negligible.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hausman: Option<Hausman>,
}

/// The noise of a joint's position, of its noisiest recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JointPositionNoise {
    /// White noise, rad.
    pub white_rad: f64,
    /// Step of the lattice of the encoder, rad.
    pub step_rad: Option<f64>,
    /// Share of the noise in the power of the filtered accelerations.
    pub acceleration_share: f64,
}

/// A coefficient's bias, which is part of its standard deviation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ParameterBias {
    /// The coefficient.
    pub name: String,
    /// By how much noise of the positions is taken to have shifted it.
    pub bias: f64,
    /// The same in standard deviations that other errors give it.
    pub deviations: f64,
}

/// Least squares, and what it was fitted to.
pub(crate) struct Fitted<'a> {
    pub model: &'a RobotModel,
    pub options: &'a CalibrationOptions,
    pub load: &'a LoadTorque,
    pub scopes: &'a TermScopes,
    pub recordings: &'a [&'a NamedRecording],
    pub system: &'a System,
    pub weights: &'a [f64],
    pub solution: &'a Solution,
}

/// What noise of the positions does to an estimate.
pub(crate) struct Looked {
    pub joints: Vec<JointPositionNoise>,
    pub draws: u64,
    /// What the noise does to least squares when it is added once more.
    pub shift: Shift,
    pub hausman: Option<Hausman>,
    /// The estimate without it and the inverse of the corrected WᵀΩ⁻¹W, column-major, where these were asked for.
    pub corrected: Option<(Vec<f64>, Vec<f64>)>,
}

/// What noise of the positions does. With `thorough` it is drawn often enough for the estimate to be corrected; a shift that is
/// `known` is not asked for again.
///
/// # Errors
/// [`CalibrationError::NoisyPositions`] if an estimate is to be corrected and noise makes up what the motion shows, and what
/// models report.
pub(crate) fn look(
    fitted: &Fitted<'_>,
    thorough: bool,
    known: Option<&Shift>,
) -> Result<Looked, CalibrationError> {
    let Fitted { model, weights, solution, .. } = *fitted;
    let joints = joints(model, fitted.recordings)?;
    let draws = if matters(&joints) { DRAWS[usize::from(thorough)] } else { 0 };
    let needed = if known.is_some() && !thorough { 0 } else { draws };
    let drawn: Vec<System> =
        (0..needed).into_par_iter().map(|draw| drawn(fitted, draw)).collect::<Result<_, _>>()?;
    let shift = match known {
        Some(known) => known.clone(),
        None => {
            let solve = |system: &System| system.solve_coefficients_of(weights, |k| solution.excited[k]);
            let estimates: Vec<Vec<f64>> = drawn.iter().map(solve).collect::<Result<_, _>>()?;
            Shift::of(model, &[], &solution.coefficients, &estimates)
        }
    };
    let hausman = if draws > 0 { agreement(fitted)? } else { None };
    let corrected = if thorough {
        let plain = Normal::of(fitted.system, weights);
        let mut corrected = plain.clone();
        for system in &drawn {
            corrected.add(&plain, 1.0 / draws as f64);
            corrected.add(&Normal::of(system, weights), -1.0 / draws as f64);
        }
        Some(corrected.solve(&solution.excited).ok_or_else(|| {
            let worst = joints
                .iter()
                .enumerate()
                .max_by(|a, b| a.1.acceleration_share.total_cmp(&b.1.acceleration_share));
            let (joint, share) = worst.map_or((0, 0.0), |(j, n)| (j, n.acceleration_share));
            CalibrationError::NoisyPositions { joint, percent: 100.0 * share }
        })?)
    } else {
        None
    };
    Ok(Looked { joints, draws, shift, hausman, corrected })
}

/// Whether instruments agree, where the recordings are long enough for their filter.
fn agreement(fitted: &Fitted<'_>) -> Result<Option<Hausman>, CalibrationError> {
    let Fitted { model, options, load, scopes, recordings, weights, solution, .. } = *fitted;
    let coefficients = &solution.coefficients;
    match (Tested { model, recordings, scopes, load, options, coefficients, weights }).test() {
        Err(CalibrationError::Recording(_)) => Ok(None),
        tested => tested,
    }
}

impl PositionBias {
    /// The bias of least squares; `deviations` are those of other errors.
    pub(crate) fn of(model: &RobotModel, looked: &Looked, deviations: impl Fn(usize) -> f64) -> Self {
        let told = |(k, bias): (usize, &f64)| {
            let deviation = deviations(k);
            let deviations = if deviation > 0.0 { bias / deviation } else { 0.0 };
            ParameterBias { name: model.parameters()[k].name.clone(), bias: *bias, deviations }
        };
        let shifted = looked.shift.coefficients().iter();
        let determined = shifted.enumerate().filter(|(k, _)| deviations(*k) > 0.0);
        Self {
            joints: looked.joints.clone(),
            draws: looked.draws,
            parameters: determined.map(told).collect(),
            hausman: looked.hausman.clone(),
        }
    }

    /// The coefficients whose intervals are wider by it, the worst first.
    #[must_use]
    pub fn notable(&self) -> Vec<&ParameterBias> {
        let mut notable: Vec<&ParameterBias> =
            self.parameters.iter().filter(|p| p.deviations.abs() > NOTABLE).collect();
        notable.sort_by(|a, b| b.deviations.abs().total_cmp(&a.deviations.abs()));
        notable
    }

    /// What to know where noise is more than corrections hold for.
    pub(crate) fn overwhelming(&self) -> Option<String> {
        let worst = self.joints.iter().enumerate();
        let (joint, noise) =
            worst.max_by(|a, b| a.1.acceleration_share.total_cmp(&b.1.acceleration_share))?;
        (noise.acceleration_share > OVERWHELMING).then(|| {
            format!(
                "noise of the positions makes up {:.0} % of the power of joint {joint}'s accelerations, more than its effect on \
                 estimates can be told or corrected for; lower f_dyn",
                100.0 * noise.acceleration_share
            )
        })
    }

    /// What to know of least squares that was not corrected.
    pub(crate) fn warning(&self) -> Option<String> {
        const NAMED: usize = 3;
        let notable = self.notable();
        let is_biased = self.hausman.as_ref().is_some_and(Hausman::is_biased);
        if notable.is_empty() && !is_biased {
            return None;
        }
        let mut warning = "noise of the positions biases".to_owned();
        if notable.is_empty() {
            warning.push_str(" coefficients");
        } else {
            let worst: Vec<String> = notable
                .iter()
                .take(NAMED)
                .map(|p| format!("{} by {:.1} standard deviations", p.name, p.deviations.abs()))
                .collect();
            warning.push_str(&format!(
                " {} of {} coefficients by more than {NOTABLE} standard deviations ({}{}), which intervals include",
                notable.len(),
                self.parameters.len(),
                worst.join(", "),
                if notable.len() > NAMED { ", …" } else { "" },
            ));
        }
        if is_biased {
            warning.push_str(": instrumental variables do not agree with them");
        }
        warning
            .push_str("; lower f_dyn, for which `aurt check` knows a value (`aurt explain position_bias`)");
        Some(warning)
    }
}

/// The filter that the positions of a recording passed.
fn position_filter(recording: &NamedRecording) -> Result<ZeroPhase, CalibrationError> {
    let report = &recording.data.report;
    Ok(ZeroPhase::butterworth(FILTER_ORDER, report.position_cutoff_hz, report.rate_hz)?)
}

/// Whether noise of the positions is more than negligible at any joint.
///
/// # Errors
/// What filters report.
pub(crate) fn position_noise_matters(
    model: &RobotModel,
    recordings: &[&NamedRecording],
) -> Result<bool, CalibrationError> {
    Ok(matters(&joints(model, recordings)?))
}

fn matters(joints: &[JointPositionNoise]) -> bool {
    joints.iter().any(|j| j.acceleration_share >= NEGLIGIBLE_SHARE)
}

fn joints(
    model: &RobotModel,
    recordings: &[&NamedRecording],
) -> Result<Vec<JointPositionNoise>, CalibrationError> {
    let mut joints: Vec<JointPositionNoise> = (0..model.joints())
        .map(|_| JointPositionNoise { white_rad: 0.0, step_rad: None, acceleration_share: 0.0 })
        .collect();
    for recording in recordings {
        let filter = position_filter(recording)?;
        for (joint, noise) in recording.data.position_noise.iter().enumerate().take(joints.len()) {
            let share = acceleration_share(&recording.data.segments, joint, noise, &filter);
            if share > joints[joint].acceleration_share {
                let PositionNoise { white_rad, step_rad, .. } = *noise;
                joints[joint] = JointPositionNoise { white_rad, step_rad, acceleration_share: share };
            }
        }
    }
    Ok(joints)
}

/// The system with the noise added once more.
fn drawn(fitted: &Fitted<'_>, draw: u64) -> Result<System, CalibrationError> {
    let noisier = noisier_recordings(fitted.recordings, draw)?;
    let Fitted { model, options, load, scopes, .. } = *fitted;
    accumulate_scoped(model, &noisier, scopes, load, options)
}

/// The recordings with the noise of their positions added once more.
pub(crate) fn noisier_recordings(
    recordings: &[&NamedRecording],
    draw: u64,
) -> Result<Vec<NamedRecording>, CalibrationError> {
    let mut random = Random::new(draw);
    recordings
        .iter()
        .map(|recording| {
            let filter = position_filter(recording)?;
            let report = &recording.data.report;
            let motion_hz = (MOTION_SHARE * report.parallel_cutoff_hz).min(MOTION_HZ);
            let smoother = ZeroPhase::butterworth(FILTER_ORDER, motion_hz, report.rate_hz)?;
            let mut own = (*recording).clone();
            for segment in &mut own.data.segments {
                *segment = noisier(segment, &own.data.position_noise, [&filter, &smoother], &mut random)?;
            }
            Ok(own)
        })
        .collect()
}

/// A = WᵀΩ⁻¹W and c = WᵀΩ⁻¹y.
#[derive(Clone)]
struct Normal {
    matrix: DMatrix<f64>,
    right: DVector<f64>,
}

impl Normal {
    fn of(system: &System, weights: &[f64]) -> Self {
        let n = system.coefficients();
        let (mut matrix, mut right) = (DMatrix::zeros(n, n), DVector::zeros(n));
        for (factor, weight) in system.factors().iter().zip(weights) {
            let (r, columns) = (factor.triangle(), factor.columns());
            let size = columns.len() + 1;
            let column = |k: usize| &r[k * size..(k + 1) * size];
            let dot = |a: usize, b: usize| -> f64 {
                weight * weight * column(a).iter().zip(column(b)).map(|(x, y)| x * y).sum::<f64>()
            };
            for (a, first) in columns.iter().enumerate() {
                right[*first] += dot(a, size - 1);
                for (b, second) in columns.iter().enumerate() {
                    matrix[(*first, *second)] += dot(a, b);
                }
            }
        }
        Self { matrix, right }
    }

    fn add(&mut self, other: &Self, factor: f64) {
        self.matrix += factor * &other.matrix;
        self.right += factor * &other.right;
    }

    /// ζ and A⁻¹ over the excited coefficients; `None` unless A is positive definite.
    fn solve(&self, excited: &[bool]) -> Option<(Vec<f64>, Vec<f64>)> {
        let n = excited.len();
        let kept: Vec<usize> = (0..n).filter(|k| excited[*k]).collect();
        let scale: Vec<f64> = kept.iter().map(|k| self.matrix[(*k, *k)].sqrt()).collect();
        if scale.iter().any(|s| !(s.is_finite() && *s > 0.0)) {
            return None;
        }
        let scaled = DMatrix::from_fn(kept.len(), kept.len(), |a, b| {
            self.matrix[(kept[a], kept[b])] / (scale[a] * scale[b])
        });
        let inverse = scaled.cholesky()?.inverse();
        let right = DVector::from_fn(kept.len(), |a, _| self.right[kept[a]] / scale[a]);
        let found = &inverse * right;
        let (mut coefficients, mut bread) = (vec![0.0; n], vec![0.0; n * n]);
        for (a, first) in kept.iter().enumerate() {
            coefficients[*first] = found[a] / scale[a];
            for (b, second) in kept.iter().enumerate() {
                bread[second * n + first] = inverse[(a, b)] / (scale[a] * scale[b]);
            }
        }
        Some((coefficients, bread))
    }
}
