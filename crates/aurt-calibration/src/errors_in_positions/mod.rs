//! Noise in the positions.
//!
//! The regressor is made from measured positions, and least squares knows only noise of the measurement y: errors ΔW of the
//! regressor pull coefficients towards zero, since E (W + ΔW)ᵀ(W + ΔW) = WᵀW + E ΔWᵀΔW. Adding the noise once more, as the
//! noise model of each joint draws it (white noise, and the lattice of the encoder on the very motion, through the filters of
//! the positions), shows what it does to the normal equations A ζ = c; taking that away once gives them without noise,
//!
//! (2A − E A*) ζ = 2c − E c*,
//!
//! corrected scores by simulation (Nakamura 1990; Novick and Stefanski 2002). One draw is added and taken away: in the mean of
//! both, what is odd in the noise is gone, and with it most of the scatter of a draw. Exact where the regressor is linear in the
//! noise; to first order in its power elsewhere. Friction turns with the sign of the velocity, where that is not enough: the
//! bias of the rigid bodies is told, and no estimate is corrected by it.

mod noise;

use std::ops::Range;

use aurt_recording::{PositionNoise, Segment, ZeroPhase};
use aurt_traits::{LoadTorque, Motion, RobotModel};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::{
    CalibrationError, CalibrationOptions, NamedRecording, Solution, System, TermScopes, accumulate_scoped,
    random::Random,
};
use noise::{acceleration_share, noisier};

/// Order of the filter of the positions, one way.
const FILTER_ORDER: usize = 4;
/// Motions lie below this share of the parallel cut-off, which is half of f_dyn, and below this frequency, Hz, as far as
/// the speed with which a joint crosses the lattice is concerned.
const MOTION_SHARE: f64 = 0.25;
const MOTION_HZ: f64 = 3.0;
/// A smaller share of noise in the accelerations is not looked at: it moves coefficients by less than it.
const NEGLIGIBLE_SHARE: f64 = 1e-4;
/// Signs with which the noise is added.
const SIGNS: [f64; 2] = [1.0, -1.0];
/// Of longer recordings, pieces of so much together stand for the whole, s.
const LOOKED_AT_S: f64 = 60.0;
/// Beyond this share of noise in accelerations first order is not enough (docs/estimation.md).
const OVERWHELMING: f64 = 0.5;
/// A bias of so many standard deviations makes intervals of 95 % hold less than 93 %.
const NOTABLE: f64 = 0.5;

/// What noise of the positions does to least squares.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PositionBias {
    /// The joints.
    pub joints: Vec<JointPositionNoise>,
    /// Draws of the noise; none where it is negligible.
    pub draws: u64,
    /// The rigid bodies' coefficients that the recordings determine.
    pub parameters: Vec<ParameterBias>,
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

/// A coefficient's bias.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ParameterBias {
    /// The coefficient.
    pub name: String,
    /// Least squares minus the estimate without it.
    pub bias: f64,
    /// The same in standard deviations of the estimate.
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

impl PositionBias {
    /// The bias of least squares, with the coefficients' deviations; nothing where noise makes up what the motion shows.
    ///
    /// # Errors
    /// What filters and models report.
    pub(crate) fn of(
        fitted: &Fitted<'_>,
        deviation: impl Fn(usize) -> f64,
    ) -> Result<Option<Self>, CalibrationError> {
        let joints = joints(fitted)?;
        if joints.iter().all(|j| j.acceleration_share < NEGLIGIBLE_SHARE) {
            return Ok(Some(Self { joints, draws: 0, parameters: Vec::new() }));
        }
        let whole = Normal::of(fitted.system, fitted.weights);
        let (pieces, times) = pieces(fitted.recordings)?;
        let plain = if times > 1.0 { normal(fitted, &pieces)? } else { whole.clone() };
        let draws = SIGNS.par_iter().map(|sign| normal(fitted, &drawn(&pieces, *sign)?));
        let mut corrected = whole;
        for drawn in draws.collect::<Result<Vec<Normal>, CalibrationError>>()? {
            corrected.add(&plain, times / SIGNS.len() as f64);
            corrected.add(&drawn, -times / SIGNS.len() as f64);
        }
        let (model, solution) = (fitted.model, fitted.solution);
        let Some(corrected) = corrected.solve(&solution.excited) else { return Ok(None) };
        // Of friction, which turns with the sign of the velocity, first order says too little.
        let parameters = (0..model.base().len())
            .filter(|k| solution.excited[*k])
            .map(|k| {
                let bias = solution.coefficients[k] - corrected[k];
                let deviation = deviation(k);
                let deviations = if deviation > 0.0 { bias / deviation } else { 0.0 };
                ParameterBias { name: model.parameters()[k].name.clone(), bias, deviations }
            })
            .collect();
        Ok(Some(Self { joints, draws: SIGNS.len() as u64, parameters }))
    }

    /// The coefficients whose intervals suffer, the worst first.
    #[must_use]
    pub fn notable(&self) -> Vec<&ParameterBias> {
        let mut notable: Vec<&ParameterBias> =
            self.parameters.iter().filter(|p| p.deviations.abs() > NOTABLE).collect();
        notable.sort_by(|a, b| b.deviations.abs().total_cmp(&a.deviations.abs()));
        notable
    }

    /// What to know where noise is more than first order tells.
    pub(crate) fn overwhelming(&self) -> Option<String> {
        let worst = self.joints.iter().enumerate();
        let (joint, noise) =
            worst.max_by(|a, b| a.1.acceleration_share.total_cmp(&b.1.acceleration_share))?;
        (noise.acceleration_share > OVERWHELMING).then(|| {
            format!(
                "noise of the positions makes up {:.0} % of the power of joint {joint}'s accelerations, more than its effect on \
                 estimates can be told; lower f_dyn",
                100.0 * noise.acceleration_share
            )
        })
    }

    /// What to know of least squares.
    pub(crate) fn warning(&self) -> Option<String> {
        const NAMED: usize = 3;
        let notable = self.notable();
        let worst: Vec<String> = notable
            .iter()
            .take(NAMED)
            .map(|p| format!("{} by {:.1} standard deviations", p.name, p.deviations))
            .collect();
        (!notable.is_empty()).then(|| {
            format!(
                "noise of the positions biases {} of {} coefficients of the rigid bodies by more than {NOTABLE} standard deviations ({}{}): their \
                 intervals hold the truth less often than they say; lower f_dyn",
                notable.len(),
                self.parameters.len(),
                worst.join(", "),
                if notable.len() > NAMED { ", …" } else { "" }
            )
        })
    }
}

/// The filter that the positions of a recording passed.
fn position_filter(recording: &NamedRecording) -> Result<ZeroPhase, CalibrationError> {
    let report = &recording.data.report;
    Ok(ZeroPhase::butterworth(FILTER_ORDER, report.position_cutoff_hz, report.rate_hz)?)
}

fn joints(fitted: &Fitted<'_>) -> Result<Vec<JointPositionNoise>, CalibrationError> {
    let mut joints: Vec<JointPositionNoise> = (0..fitted.model.joints())
        .map(|_| JointPositionNoise { white_rad: 0.0, step_rad: None, acceleration_share: 0.0 })
        .collect();
    for recording in fitted.recordings {
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

/// The middle of each segment, in proportion to its length, and how many times all that the pieces are.
fn pieces(recordings: &[&NamedRecording]) -> Result<(Vec<NamedRecording>, f64), CalibrationError> {
    let long_s = |s: &Segment| s.motion.samples() as f64 / s.rate_hz;
    let total_s: f64 = recordings.iter().flat_map(|r| &r.data.segments).map(long_s).sum();
    let share = (LOOKED_AT_S / total_s).min(1.0);
    let mut pieces: Vec<NamedRecording> = recordings.iter().map(|r| (*r).clone()).collect();
    if share == 1.0 {
        return Ok((pieces, 1.0));
    }
    let (mut all, mut kept) = (0, 0);
    for segment in pieces.iter_mut().flat_map(|r| &mut r.data.segments) {
        let rows = segment.rows();
        let count = ((share * rows as f64).ceil() as usize).min(rows);
        *segment = piece(segment, (rows - count) / 2..(rows - count) / 2 + count)?;
        all += rows;
        kept += count;
    }
    Ok((pieces, all as f64 / kept.max(1) as f64))
}

/// Some rows of a segment, and the motion that they are of.
fn piece(segment: &Segment, rows: Range<usize>) -> Result<Segment, CalibrationError> {
    let view = segment.motion.view();
    let samples =
        rows.start * segment.decimation..(rows.end * segment.decimation).min(segment.motion.samples());
    let part = view.slice(samples);
    let joints = part.joints();
    let motion = Motion::new(
        joints,
        part.time_s().to_vec(),
        (0..joints).flat_map(|j| part.position_rad(j).to_vec()).collect(),
        (0..joints).flat_map(|j| part.velocity_rad_s(j).to_vec()).collect(),
        (0..joints).flat_map(|j| part.acceleration_rad_s2(j).to_vec()).collect(),
    )?;
    let measurement =
        segment.measurement.as_ref().map(|m| m.iter().map(|y| y[rows.clone()].to_vec()).collect());
    Ok(Segment {
        motion,
        measurement,
        raw_measurement: None,
        rate_hz: segment.rate_hz,
        decimation: segment.decimation,
        parallel_filter: segment.parallel_filter.clone(),
    })
}

/// The recordings with the noise added once more; the same noise for either sign.
fn drawn(recordings: &[NamedRecording], sign: f64) -> Result<Vec<NamedRecording>, CalibrationError> {
    let mut random = Random::new(0);
    let mut noisier = |recording: &NamedRecording| {
        let filter = position_filter(recording)?;
        let report = &recording.data.report;
        let motion_hz = (MOTION_SHARE * report.parallel_cutoff_hz).min(MOTION_HZ);
        let smoother = ZeroPhase::butterworth(FILTER_ORDER, motion_hz, report.rate_hz)?;
        let mut own = recording.clone();
        for segment in &mut own.data.segments {
            *segment = noisier(segment, &own.data.position_noise, [&filter, &smoother], sign, &mut random)?;
        }
        Ok(own)
    };
    recordings.iter().map(&mut noisier).collect()
}

fn normal(fitted: &Fitted<'_>, recordings: &[NamedRecording]) -> Result<Normal, CalibrationError> {
    let Fitted { model, options, load, scopes, weights, .. } = *fitted;
    Ok(Normal::of(&accumulate_scoped(model, recordings, scopes, load, options)?, weights))
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

    /// ζ over the excited coefficients; `None` unless A is positive definite.
    fn solve(&self, excited: &[bool]) -> Option<Vec<f64>> {
        let n = excited.len();
        let kept: Vec<usize> = (0..n).filter(|k| excited[*k]).collect();
        let scale: Vec<f64> = kept.iter().map(|k| self.matrix[(*k, *k)].sqrt()).collect();
        if scale.iter().any(|s| !(s.is_finite() && *s > 0.0)) {
            return None;
        }
        let scaled = DMatrix::from_fn(kept.len(), kept.len(), |a, b| {
            self.matrix[(kept[a], kept[b])] / (scale[a] * scale[b])
        });
        let right = DVector::from_fn(kept.len(), |a, _| self.right[kept[a]] / scale[a]);
        let found = scaled.cholesky()?.solve(&right);
        let mut coefficients = vec![0.0; n];
        for (a, column) in kept.iter().enumerate() {
            coefficients[*column] = found[a] / scale[a];
        }
        Some(coefficients)
    }
}
