//! How much of each joint's measurement a calibrated model explains.

use aurt::{RecordingResult, Role};
use aurt_traits::RobotNames;

/// Below this share a joint counts as hardly explained.
pub(super) const LEAST_EXPLAINED: f64 = 0.5;

/// A joint that a model hardly explains.
#[derive(Debug, Clone, PartialEq)]
pub struct Poor {
    /// The joint.
    pub joint: usize,
    /// What of it is explained at the worst recording: 1 − Σe²/Σy² over the rows at which it moves, 0 at least.
    pub explained: f64,
    /// The recording.
    pub recording: String,
}

/// The joints that a model hardly explains, on held-out recordings or, without any, on those it was fitted to. Joints that
/// rest are left out: what holds them is friction that knows no sign.
#[must_use]
pub fn poorly_explained(recordings: &[RecordingResult]) -> Vec<Poor> {
    let held_out = recordings.iter().any(|r| r.role == Role::Validation);
    let role = if held_out { Role::Validation } else { Role::Calibration };
    let mut worst: Vec<Poor> = Vec::new();
    for result in recordings.iter().filter(|r| r.role == role) {
        let moving = &result.validation.moving;
        for (joint, (error, samples)) in moving.nrmse.iter().zip(&moving.samples).enumerate() {
            let explained = if error.is_nan() { continue } else { (1.0 - error * error).max(0.0) };
            // A few rows say little.
            if explained >= LEAST_EXPLAINED || *samples * 10 < result.validation.samples {
                continue;
            }
            let poor = Poor { joint, explained, recording: result.label.clone() };
            match worst.iter_mut().find(|w| w.joint == joint) {
                Some(known) if known.explained <= explained => {}
                Some(known) => *known = poor,
                None => worst.push(poor),
            }
        }
    }
    worst.sort_by_key(|w| w.joint);
    worst
}

/// The sentence that says so: `This model explains 4 % of joint 2 (point_to_point.csv)`, or nothing of it.
#[must_use]
pub fn loudly(poor: &[Poor], names: RobotNames<'_>) -> Option<String> {
    if poor.is_empty() {
        return None;
    }
    let each: Vec<String> = poor
        .iter()
        .map(|p| {
            let name = p.recording.rsplit(['/', '\\']).next().unwrap_or(&p.recording);
            let share = if p.explained < 0.005 {
                "nothing".to_owned()
            } else {
                format!("{:.0} %", 100.0 * p.explained)
            };
            format!("{share} of {} ({name})", names.joint(p.joint))
        })
        .collect();
    Some(format!("This model explains {}.", each.join(", ")))
}
