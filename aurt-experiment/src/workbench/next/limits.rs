//! Limits that recordings show.

use aurt_diagnosis::QuestionedRecording;
use aurt_simulation::MotionLimits;
use aurt_traits::RobotNames;

/// A joint that never moved may turn within this, rad, and at this speed, rad/s: nothing says that it may move farther.
const STANDING: [f64; 2] = [0.005, 0.02];
/// Time to the full speed of such a joint, s.
const TO_FULL_SPEED_S: f64 = 0.5;
/// Limits by joint: where it has been, and how fast.
pub(super) fn limits_of(
    recordings: &[QuestionedRecording],
    names: RobotNames<'_>,
) -> (Vec<MotionLimits>, Vec<String>) {
    let joints = recordings.first().map_or(0, |r| r.raw.joints());
    let mut standing = Vec::new();
    let mut of_joint = |j: usize| {
        let motions = || recordings.iter().flat_map(|r| &r.data.data.segments).map(|s| s.motion.view());
        let most = |series: &[f64], most: f64| series.iter().fold(most, |most, v| most.max(v.abs()));
        let positions = || motions().flat_map(|m| m.position_rad(j));
        let mut range = [
            positions().fold(f64::INFINITY, |low, q| low.min(*q)),
            positions().fold(f64::NEG_INFINITY, |high, q| high.max(*q)),
        ];
        let mut velocity_rad_s = motions().fold(0.0, |v, m| most(m.velocity_rad_s(j), v));
        let mut acceleration_rad_s2 = motions().fold(0.0, |a, m| most(m.acceleration_rad_s2(j), a));
        if range[1] - range[0] < 2.0 * STANDING[0] || velocity_rad_s < STANDING[1] {
            standing.push(j);
            let middle = 0.5 * (range[0] + range[1]);
            range = [middle - STANDING[0], middle + STANDING[0]];
            velocity_rad_s = STANDING[1];
            acceleration_rad_s2 = STANDING[1] / TO_FULL_SPEED_S;
        }
        MotionLimits { position_rad: range, velocity_rad_s, acceleration_rad_s2 }
    };
    let limits = (0..joints).map(&mut of_joint).collect();
    let mut notes = vec![
        "limits: what the recordings show of positions, speeds, accelerations and torques; --limits gives others".to_owned(),
    ];
    if !standing.is_empty() {
        notes.push(format!("never moved, and hardly moved in the plan: {}", names.joint_list(&standing)));
    }
    (limits, notes)
}
