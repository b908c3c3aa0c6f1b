//! A setup without a mistake.

use std::sync::{Arc, OnceLock};

use aurt_recording::Recording;

use super::mistake::{Mistake, Reading, Table};
use super::setup::{Part, Setup};

impl Mistake {
    pub fn undone(&self, setup: &Setup) -> Setup {
        let mut undone = setup.undone.clone();
        undone.push(self.clone());
        let setup = match self {
            Self::Gravity { to_m_s2 } => {
                Setup { gravity_m_s2: *to_m_s2, model: OnceLock::new(), ..setup.clone() }
            }
            Self::Geometry { what: Table::Zero { joint, offset_rad, .. }, .. } => {
                let mut joints = setup.joints.clone();
                joints[*joint].theta_offset_rad += offset_rad;
                Setup { joints, model: OnceLock::new(), ..setup.clone() }
            }
            Self::Geometry { joints, .. } => {
                Setup { joints: joints.clone(), model: OnceLock::new(), ..setup.clone() }
            }
            Self::Reading { what, file } => {
                let concerned = |part: &&Part| file.is_none_or(|f| f == part.file);
                let parts = setup
                    .parts
                    .iter()
                    .map(|part| if concerned(&part) { what.undone(part) } else { part.clone() })
                    .collect();
                Setup { parts, ..setup.clone() }
            }
        };
        Setup { undone, ..setup }
    }
}

impl Reading {
    fn undone(&self, part: &Part) -> Part {
        let mut recording: Recording = (*part.recording).clone();
        let mut options = part.options.clone();
        let scale = |series: &mut Vec<f64>, factor: f64| series.iter_mut().for_each(|v| *v *= factor);
        let all_positions = |recording: &mut Recording, factor: f64| {
            recording.position_rad.iter_mut().for_each(|q| scale(q, factor));
        };
        match self {
            Self::Degrees => all_positions(&mut recording, 1_f64.to_radians()),
            Self::Turns => all_positions(&mut recording, std::f64::consts::TAU),
            Self::Geared(ratio) => all_positions(&mut recording, 1.0 / ratio),
            Self::PositionSign(joint) => scale(&mut recording.position_rad[*joint], -1.0),
            Self::AxisSign(joint) => {
                scale(&mut recording.position_rad[*joint], -1.0);
                measured(&mut recording, *joint, -1.0);
            }
            Self::MeasurementSign(joint) => measured(&mut recording, *joint, -1.0),
            Self::AllMeasurementSigns => {
                (0..recording.joints()).for_each(|joint| measured(&mut recording, joint, -1.0));
            }
            Self::Gain { joint, factor } => measured(&mut recording, *joint, *factor),
            Self::Constants { joints: [a, b], factor } => {
                measured(&mut recording, *a, *factor);
                measured(&mut recording, *b, 1.0 / factor);
            }
            Self::Order { of, order } => {
                let ordered = |family: &[Vec<f64>]| order.iter().map(|j| family[*j].clone()).collect();
                if of.positions() {
                    recording.position_rad = ordered(&recording.position_rad);
                }
                if of.measurements() {
                    recording.measurement = recording.measurement.as_deref().map(ordered);
                }
            }
            Self::Delay(delay_s) => {
                let options = Arc::make_mut(&mut options);
                let before = options.delay_s.take().unwrap_or_else(|| vec![0.0; recording.joints()]);
                options.delay_s = Some(before.iter().map(|d| d + delay_s).collect());
            }
            Self::Time(factor) => {
                scale(&mut recording.time_s, *factor);
                let options = Arc::make_mut(&mut options);
                options.f_dyn_hz /= factor;
                options.rest_velocity_rad_s /= factor;
            }
            Self::During { what, span_s } => {
                let other = what.undone(part).recording;
                let [from_s, to_s] = *span_s;
                for (row, stamp) in part.recording.time_s.iter().enumerate() {
                    let at_s = stamp - part.origin_s;
                    if from_s.is_none_or(|from| at_s >= from) && to_s.is_none_or(|to| at_s < to) {
                        put(&mut recording.position_rad, &other.position_rad, row);
                        if let (Some(to), Some(from)) = (&mut recording.measurement, &other.measurement) {
                            put(to, from, row);
                        }
                    }
                }
            }
        }
        let mut part = part.with(Arc::new(recording), options);
        part.slow_rad_s *= self.speed();
        if let Self::Time(factor) = self {
            part.origin_s *= factor;
        }
        part
    }

    fn speed(&self) -> f64 {
        match self {
            Self::Degrees => 1_f64.to_radians(),
            Self::Turns => std::f64::consts::TAU,
            Self::Geared(factor) | Self::Time(factor) => 1.0 / factor,
            _ => 1.0,
        }
    }
}

/// Takes a row from the same series elsewhere.
fn put(to: &mut [Vec<f64>], from: &[Vec<f64>], row: usize) {
    to.iter_mut().zip(from).for_each(|(to, from)| to[row] = from[row]);
}

fn measured(recording: &mut Recording, joint: usize, factor: f64) {
    if let Some(series) = recording.measurement.as_mut().and_then(|m| m.get_mut(joint)) {
        series.iter_mut().for_each(|v| *v *= factor);
    }
}
