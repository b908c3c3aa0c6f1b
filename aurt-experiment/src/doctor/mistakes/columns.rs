//! What columns show by themselves, without a model: nothing, the same as another, or what no joint can do.

use std::f64::consts::TAU;

use aurt_recording::Recording;
use aurt_traits::{MeasurementUnit, RobotNames};

use super::slips::slips;
use crate::doctor::inspection::series::{range, rms};

/// A joint that moves no more than this rests, rad.
const REST_RAD: f64 = 1e-4;
/// Turns from which on a position is hardly that of an arm's joint.
const MANY_TURNS: f64 = 3.0;
/// Root mean square of motor currents from which on they are hardly in A.
const LARGE_CURRENT_A: f64 = 150.0;
/// Root mean square of joint torques from which on they are hardly in Nm.
const LARGE_TORQUE_NM: f64 = 1e4;
/// Two series of which this much is alike are one.
const ALIKE: f64 = 1e-9;

pub fn oddities(name: &str, recording: &Recording) -> Vec<String> {
    let mut said = Vec::new();
    let names = RobotNames::of_joints(recording.joints.names());
    let joints = recording.joints();
    let spans: Vec<f64> = recording.position_rad.iter().map(|q| span(q)).collect();
    for joint in 0..joints {
        for other in joint + 1..joints {
            if spans[joint] > REST_RAD && same(&recording.position_rad[joint], &recording.position_rad[other])
            {
                said.push(format!(
                    "{name}: the positions of {} are the same column; select each joint's own with `columns`",
                    names.joint_list(&[joint, other])
                ));
            }
        }
    }
    let fastest = spans.iter().copied().fold(0.0, f64::max);
    if fastest > MANY_TURNS * TAU {
        let joint = spans.iter().position(|s| *s == fastest).unwrap_or_default();
        said.push(format!(
            "{name}: {} covers {fastest:.0} rad, {:.1} turns; if positions are in degrees, write \
             `angle = \"deg\"` in `[recordings]`, if they are the motors', `gear_ratio`, if they are counts, \
             `counts_per_revolution`",
            names.joint(joint),
            fastest / TAU
        ));
    }
    if let Some(velocity) = &recording.velocity_rad_s {
        for joint in 0..joints {
            if spans[joint] <= REST_RAD && span(&velocity[joint]) > 0.1 {
                said.push(format!(
                    "{name}: the position of {} stands still while its velocity column varies by {:.2} rad/s; \
                     its position column is another's or was not logged",
                    names.joint(joint),
                    span(&velocity[joint])
                ));
            }
        }
    }
    said.extend(slips(name, recording));
    if let Some(measurement) = &recording.measurement {
        said.extend(of_measurements(name, recording, measurement, &spans));
    }
    said
}

fn of_measurements(
    name: &str,
    recording: &Recording,
    measurement: &[Vec<f64>],
    spans: &[f64],
) -> Vec<String> {
    let mut said = Vec::new();
    let names = RobotNames::of_joints(recording.joints.names());
    let joints = measurement.len();
    let constant: Vec<usize> =
        (0..joints).filter(|j| span(&measurement[*j]) == 0.0 && recording.samples() > 10).collect();
    let silent = |j: &&usize| spans[**j] > REST_RAD && measurement[**j].first() == Some(&0.0);
    let all: Vec<String> = constant.iter().filter(silent).map(ToString::to_string).collect();
    if joints > 1 && all.len() == joints {
        said.push(format!(
            "{name}: the measurements of all joints are constantly 0, though they move: they were not logged, or `columns` or \
             `topic` select others; nothing can be calibrated on them"
        ));
    }
    for joint in constant.iter().filter(|j| spans[**j] > REST_RAD && all.len() < joints.max(2)) {
        said.push(format!(
            "{name}: the measurement of {} is constantly {}, though the joint moves: it was not logged, or \
             `columns` select another column; nothing can be said of its friction",
            names.joint(*joint),
            // Not −0.
            measurement[*joint].first().copied().unwrap_or_default() + 0.0
        ));
    }
    for joint in 0..joints {
        for other in joint + 1..joints {
            if !constant.contains(&joint) && same(&measurement[joint], &measurement[other]) {
                said.push(format!(
                    "{name}: the measurements of {} are the same column; select each joint's own with `columns`",
                    names.joint_list(&[joint, other])
                ));
            }
        }
        let motions =
            [("position", Some(&recording.position_rad)), ("velocity", recording.velocity_rad_s.as_ref())];
        for (what, family) in motions {
            let twin = family
                .and_then(|f| f.iter().position(|s| span(s) > REST_RAD && same(s, &measurement[joint])));
            if let Some(twin) = twin {
                said.push(format!(
                    "{name}: the measurement of {} is the {what} of {}; select the columns of currents or torques with \
                     `columns`",
                    names.joint(joint),
                    names.joint(twin)
                ));
            }
        }
    }
    let largest = measurement.iter().map(|m| rms(m)).fold(0.0, f64::max);
    let (limit, remedy) = match recording.unit {
        MeasurementUnit::Ampere => {
            (LARGE_CURRENT_A, "if currents are in mA, write `current = \"mA\"` in `[recordings]`")
        }
        MeasurementUnit::NewtonMetre => {
            (LARGE_TORQUE_NM, "if they are in Nmm, write 0.001 for every joint as `gains` of `[instrument]`")
        }
    };
    if largest > limit {
        said.push(format!(
            "{name}: measurements reach {largest:.0} {} in root mean square, beyond any drive; {remedy}",
            recording.unit.symbol()
        ));
    }
    said
}

fn span(series: &[f64]) -> f64 {
    let [low, high] = range(series);
    if high >= low { high - low } else { 0.0 }
}

fn same(a: &[f64], b: &[f64]) -> bool {
    let difference: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
    let size: f64 = a.iter().map(|v| v * v).sum();
    span(a) > 0.0 && difference <= ALIKE * size
}
