use aurt_recording::{PositionNoise, ZeroPhase, suitable_f_dyn_hz};
use aurt_traits::RobotModel;
use rayon::prelude::*;

use super::noise::{acceleration_share, noisier};
use super::report::{FittedBandwidth, JointPositionNoise, Looked};
use super::shift::Shift;
use crate::rows::Observed;
use crate::statistics::Random;
use crate::{CalibrationError, NamedRecording, Solution, System, accumulate};

const FILTER_ORDER: usize = 4;
/// Motions lie below this share of the parallel cut-off, which is half of f_dyn, and below this frequency, Hz, as far as
/// the speed with which a joint crosses the lattice is concerned.
const MOTION_SHARE: f64 = 0.25;
const MOTION_HZ: f64 = 3.0;
/// A smaller share of noise in the accelerations is not looked at: it moves coefficients by less than it.
const NEGLIGIBLE_SHARE: f64 = 1e-4;
/// Draws of the noise that a bias is shown from.
pub(crate) const DRAWS: u64 = 4;

pub(crate) struct Fitted<'a> {
    pub rows: Observed<'a>,
    pub weights: &'a [f64],
    pub solution: &'a Solution,
}

/// The effect of noise of the positions; a shift that is `known` is not asked for again.
pub(crate) fn look(fitted: &Fitted<'_>, known: Option<&Shift>) -> Result<Looked, CalibrationError> {
    let Fitted { rows, weights, solution, .. } = *fitted;
    let joints = joints(rows.model, rows.recordings)?;
    let draws = if matters(&joints) { DRAWS } else { 0 };
    let shift = match known {
        Some(known) => known.clone(),
        None => {
            let solve = |system: System| system.solve_coefficients_of(weights, |k| solution.excited[k]);
            let estimates: Vec<Vec<f64>> = (0..draws)
                .into_par_iter()
                .map(|draw| solve(drawn(&rows, draw)?))
                .collect::<Result<_, _>>()?;
            Shift::of(rows.model, &[], &solution.coefficients, &estimates)
        }
    };
    let f_dyn = if draws > 0 { bandwidth(rows.recordings) } else { None };
    Ok(Looked { joints, f_dyn, draws, shift })
}

/// The f_dyn of recordings, and that which suits their motion.
fn bandwidth(recordings: &[&NamedRecording]) -> Option<FittedBandwidth> {
    let suitable_hz = suitable_f_dyn_hz(recordings.iter().map(|recording| &recording.data))?;
    // The parallel filter cuts at twice f_dyn.
    let f_dyn_hz = recordings.first()?.data.report.parallel_cutoff_hz / 2.0;
    Some(FittedBandwidth { f_dyn_hz, suitable_hz })
}

fn position_filter(recording: &NamedRecording) -> Result<ZeroPhase, CalibrationError> {
    Ok(recording.data.report.position_filter()?)
}

/// Whether noise of the positions is more than negligible at any joint.
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
fn drawn(rows: &Observed<'_>, draw: u64) -> Result<System, CalibrationError> {
    let noisier = noisier_recordings(rows.recordings, draw)?;
    accumulate(rows.model, &noisier, rows.scopes, rows.load, rows.options)
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
