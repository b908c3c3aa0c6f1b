//! What the trees predict a joint's residual from.

use aurt_traits::RobotNames;

use crate::recordings::rows::{RecordingRows, Role};

/// Velocity scale at which the direction of motion is clear, rad/s.
const DIRECTION_RAD_S: f64 = 0.02;

/// By how much positions on the way back are shifted, rad: no joint travels as far.
const BACK_RAD: f64 = 1e3;

/// Names of the features of a joint that a remainder can follow, in the order of [`of_rows`].
pub(super) fn names(joints: usize, joint: usize, robot: RobotNames<'_>) -> Vec<String> {
    let of = |what: &str, k: usize| {
        if k == joint { what.to_owned() } else { format!("{what} of {}", robot.joint(k)) }
    };
    let mut names: Vec<String> = (0..joints).map(|k| of("position", k)).collect();
    names.extend((0..joints).map(|k| of("velocity", k)));
    names.extend(
        [
            "acceleration",
            "direction of motion",
            "load torque",
            "position since reversal",
            "position and direction of motion",
        ]
        .map(String::from),
    );
    names
}

/// The features of a joint's rows, `[feature][row]`; `load_torque` is the rigid bodies' torque at each row. The last tells the
/// calibration recordings from the others: the targets alone may show what is left.
pub(super) fn of_rows(rows: &RecordingRows, joint: usize, load_torque: Vec<f64>) -> Vec<Vec<f64>> {
    let own = &rows.joints[joint];
    let mut features: Vec<Vec<f64>> = rows.joints.iter().map(|j| j.position_rad.clone()).collect();
    features.extend(rows.joints.iter().map(|j| j.velocity_rad_s.clone()));
    features.push(own.acceleration_rad_s2.clone());
    features.push(own.velocity_rad_s.iter().map(|v| (v / DIRECTION_RAD_S).tanh()).collect());
    features.push(load_torque);
    features.push(since_reversal(rows, joint));
    // Friction of a place has no mean over positions or over directions, which a first split would find.
    let back = |(q, v): (&f64, &f64)| if *v < 0.0 { q - BACK_RAD } else { *q };
    features.push(own.position_rad.iter().zip(&own.velocity_rad_s).map(back).collect());
    features.push(vec![f64::from(u8::from(rows.role != Role::Calibration)); rows.rows()]);
    features
}

/// √|q − q_r| · sgn q̇, q_r the angle at which the joint last reversed: presliding friction changes over the first travel.
fn since_reversal(recording: &RecordingRows, joint: usize) -> Vec<f64> {
    let rows = &recording.joints[joint];
    let mut anchor = rows.position_rad.first().copied().unwrap_or(0.0);
    let mut sign = 0.0;
    rows.position_rad
        .iter()
        .zip(&rows.velocity_rad_s)
        .map(|(q, v)| {
            if *v != 0.0 && v.signum() != sign {
                sign = v.signum();
                anchor = *q;
            }
            sign * (q - anchor).abs().sqrt()
        })
        .collect()
}
