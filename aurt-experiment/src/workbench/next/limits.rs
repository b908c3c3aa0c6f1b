//! Limits that recordings show.

use aurt_simulation::MotionLimits;
use aurt_traits::RobotNames;

use super::NextOptions;
use crate::workbench::failure::Failure;

/// A joint that never moved may turn within this, rad, and at this speed, rad/s: nothing says that it may move farther.
const STANDING: [f64; 2] = [0.005, 0.02];
/// Time to the full speed of such a joint, s.
const TO_FULL_SPEED_S: f64 = 0.5;

/// Where a joint has been, its largest speed and its largest acceleration.
pub(super) type JointMotion = ([f64; 2], f64, f64);

/// Limits by joint: those that were given, or what recordings show of their motions; and what to note of them.
pub(super) fn limits_of(
    options: &NextOptions,
    joints: Vec<JointMotion>,
    names: RobotNames<'_>,
    shown: &str,
) -> Result<(Vec<MotionLimits>, Vec<String>), Failure> {
    match &options.limits {
        Some(limits) if limits.len() == joints.len() => return Ok((limits.clone(), Vec::new())),
        Some(limits) => {
            let reason = format!("has limits of {} joints, the robot has {}", limits.len(), joints.len());
            return Err(Failure::argument("--limits", reason, "write a row for each joint"));
        }
        None => {}
    }
    let mut standing = Vec::new();
    let mut of_joint =
        |(j, (mut range, mut velocity_rad_s, mut acceleration_rad_s2)): (usize, JointMotion)| {
            if range[1] - range[0] < 2.0 * STANDING[0] || velocity_rad_s < STANDING[1] {
                standing.push(j);
                let middle = 0.5 * (range[0] + range[1]);
                range = [middle - STANDING[0], middle + STANDING[0]];
                velocity_rad_s = STANDING[1];
                acceleration_rad_s2 = STANDING[1] / TO_FULL_SPEED_S;
            }
            MotionLimits { position_rad: range, velocity_rad_s, acceleration_rad_s2 }
        };
    let limits = joints.into_iter().enumerate().map(&mut of_joint).collect();
    let mut notes = vec![format!("limits: what the recordings show of {shown}; --limits gives others")];
    if !standing.is_empty() {
        notes.push(format!("never moved, and hardly moved in the plan: {}", names.joint_list(&standing)));
    }
    Ok((limits, notes))
}
