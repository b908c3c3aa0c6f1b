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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dice::Dice;
    use crate::recordings::rows::JointRows;
    use crate::remainder::{Residual, Rest, remainders};

    #[test]
    fn friction_of_a_place_is_followed_though_neither_place_nor_direction_has_a_mean() {
        let rows = |phase: f64| {
            let time_s: Vec<f64> = (0..4000).map(|k| 0.02 * f64::from(k)).collect();
            let sum = |of: fn(f64, f64) -> f64| -> Vec<f64> {
                time_s.iter().map(|t| of(0.7, t + phase) + 0.4 * of(1.9, t + 2.0 * phase)).collect()
            };
            let joint = JointRows {
                position_rad: sum(|w, t| (w * t).sin()),
                velocity_rad_s: sum(|w, t| w * (w * t).cos()),
                acceleration_rad_s2: sum(|w, t| -w * w * (w * t).sin()),
                counts: vec![true; 4000],
                rest_velocity: 0.0,
                measurement: vec![0.0; 4000],
                data: Vec::new(),
            };
            RecordingRows {
                name: "a motion".into(),
                role: Role::Calibration,
                rate_hz: 50.0,
                segment_starts: vec![0, 4000],
                time_s,
                joints: vec![joint],
            }
        };
        let recordings = [rows(0.0), rows(1.0)];
        let residual = |rows: &RecordingRows, seed: u64| {
            let (joint, mut dice) = (&rows.joints[0], Dice(seed));
            let place = |(q, v): (&f64, &f64)| {
                v.signum() * ((-((q - 0.3) / 0.15).powi(2)).exp() - 0.13) + 0.1 * dice.normal()
            };
            vec![joint.position_rad.iter().zip(&joint.velocity_rad_s).map(place).collect::<Vec<f64>>()]
        };
        let of = |k: usize| {
            let left = residual(&recordings[k], k as u64);
            Residual {
                rows: &recordings[k],
                before: left.clone(),
                after: left,
                load_torque: vec![vec![0.0; 4000]],
                noise: &[0.01],
            }
        };
        let (found, _) = remainders(&[of(0)], &[of(1)], false, RobotNames::default());
        assert_eq!(found[0].rest, Rest::Something);
        assert_eq!(found[0].follows[0].feature, "position and direction of motion");
    }
}
