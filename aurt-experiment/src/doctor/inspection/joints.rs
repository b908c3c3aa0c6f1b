//! What a recording covers and how its sensors are, joint by joint.

use aurt_recording::{Preprocessed, Recording};
use aurt_report::rendering::number::significant;
use aurt_traits::{MeasurementUnit, RobotNames};
use serde::Serialize;

use super::series::{range, resolution, reversals, rms, white_noise};

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointReport {
    pub position_rad: [f64; 2],
    pub max_velocity_rad_s: f64,
    pub max_acceleration_rad_s2: f64,
    pub moving_share: f64,
    pub reversals: usize,
    /// 99.9 % of the power of its velocity lies below this, Hz.
    pub bandwidth_hz: Option<f64>,
    pub position_step_rad: Option<f64>,
    pub position_noise_rad: Option<f64>,
    pub measurement: Option<MeasurementReport>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeasurementReport {
    pub range: [f64; 2],
    pub rms: f64,
    pub step: Option<f64>,
    pub noise: Option<f64>,
}

impl JointReport {
    pub fn of(recording: &Recording, prepared: &Preprocessed, rest_velocity_rad_s: f64) -> Vec<Self> {
        (0..recording.joints())
            .map(|joint| Self::joint(recording, prepared, joint, rest_velocity_rad_s))
            .collect()
    }

    fn joint(recording: &Recording, prepared: &Preprocessed, joint: usize, rest_velocity_rad_s: f64) -> Self {
        let position = &recording.position_rad[joint];
        let motions = || prepared.segments.iter().map(|s| s.motion.view());
        let largest =
            |series: &mut dyn Iterator<Item = &[f64]>| series.flatten().fold(0.0_f64, |m, v| m.max(v.abs()));
        let samples: usize = motions().map(|m| m.samples()).sum();
        let moving: usize =
            motions().flat_map(|m| m.velocity_rad_s(joint)).filter(|v| v.abs() > rest_velocity_rad_s).count();
        let longest = prepared.segments.iter().max_by_key(|s| s.motion.samples());
        Self {
            position_rad: range(position),
            max_velocity_rad_s: largest(&mut motions().map(|m| m.velocity_rad_s(joint))),
            max_acceleration_rad_s2: largest(&mut motions().map(|m| m.acceleration_rad_s2(joint))),
            moving_share: moving as f64 / samples.max(1) as f64,
            reversals: motions().map(|m| reversals(m.velocity_rad_s(joint), rest_velocity_rad_s)).sum(),
            bandwidth_hz: if moving > 0 { prepared.bandwidth_hz(joint) } else { None },
            position_step_rad: resolution(position),
            position_noise_rad: white_noise(position),
            measurement: recording.measurement.as_ref().map(|m| {
                let series = &m[joint];
                let raw = longest.and_then(|s| s.raw_measurement.as_ref()).map(|m| m[joint].as_slice());
                MeasurementReport {
                    range: range(series),
                    rms: rms(series),
                    step: resolution(series),
                    noise: white_noise(raw.unwrap_or(series)),
                }
            }),
        }
    }

    pub fn moves(&self) -> bool {
        self.moving_share > 0.0
    }
}

/// Motion and sensors as two tables, each its headings and its rows.
pub fn tables(
    joints: &[JointReport],
    unit: MeasurementUnit,
    names: RobotNames<'_>,
) -> [(Vec<String>, Vec<Vec<String>>); 2] {
    let short = |value: f64| significant(value, 3);
    let maybe = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), short);
    let motion =
        ["joint", "from rad", "to rad", "|q̇| rad/s", "|q̈| rad/s²", "moving %", "reversals", "below Hz"];
    let motion_of = |(j, joint): (usize, &JointReport)| {
        vec![
            names.joint_cell(j),
            short(joint.position_rad[0]),
            short(joint.position_rad[1]),
            short(joint.max_velocity_rad_s),
            short(joint.max_acceleration_rad_s2),
            format!("{:.0}", 100.0 * joint.moving_share),
            joint.reversals.to_string(),
            maybe(joint.bandwidth_hz),
        ]
    };
    let measured = ["from", "to", "rms", "step", "noise"].map(|of| format!("{of} {}", unit.symbol()));
    let sensors = ["joint", "step rad", "noise rad"].map(str::to_owned).into_iter().chain(measured);
    let sensors_of = |(j, joint): (usize, &JointReport)| {
        let m = joint.measurement.as_ref();
        vec![
            names.joint_cell(j),
            maybe(joint.position_step_rad),
            maybe(joint.position_noise_rad),
            maybe(m.map(|m| m.range[0])),
            maybe(m.map(|m| m.range[1])),
            maybe(m.map(|m| m.rms)),
            maybe(m.and_then(|m| m.step)),
            maybe(m.and_then(|m| m.noise)),
        ]
    };
    [
        (motion.map(str::to_owned).into(), joints.iter().enumerate().map(motion_of).collect()),
        (sensors.collect(), joints.iter().enumerate().map(sensors_of).collect()),
    ]
}
