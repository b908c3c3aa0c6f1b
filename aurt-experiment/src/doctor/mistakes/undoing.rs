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
        let mut recording = Recording::clone(&part.recording);
        let mut options = part.options.clone();
        recording.position_rad = read(&recording.position_rad, |joint| self.positioned_as(joint));
        recording.measurement = recording.measurement.map(|all| read(&all, |joint| self.measured_as(joint)));
        match self {
            Self::Delay(delay_s) => {
                let options = Arc::make_mut(&mut options);
                let before = options.delay_s.take().unwrap_or_else(|| vec![0.0; recording.joints()]);
                options.delay_s = Some(before.iter().map(|d| d + delay_s).collect());
            }
            Self::Time(factor) => {
                recording.time_s.iter_mut().for_each(|t| *t *= factor);
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
            _ => {}
        }
        let mut part = part.with(Arc::new(recording), options);
        part.slow_rad_s *= self.angle();
        if let Self::Time(factor) = self {
            part.slow_rad_s *= 1.0 / factor;
            part.origin_s *= factor;
        }
        part
    }

    /// The joint in whose column the position of a joint is, and what it is multiplied with.
    fn positioned_as(&self, joint: usize) -> (usize, f64) {
        match self {
            Self::PositionSign(own) | Self::AxisSign(own) if *own == joint => (joint, -1.0),
            Self::Order { of, order } if of.positions() => (order[joint], 1.0),
            _ => (joint, self.angle()),
        }
    }

    /// The same of a measurement.
    pub(super) fn measured_as(&self, joint: usize) -> (usize, f64) {
        match self {
            Self::MeasurementSign(own) | Self::AxisSign(own) if *own == joint => (joint, -1.0),
            Self::AllMeasurementSigns => (joint, -1.0),
            Self::Gain { joint: own, factor } if *own == joint => (joint, *factor),
            Self::Constants { joints: [own, _], factor } if *own == joint => (joint, *factor),
            Self::Constants { joints: [_, own], factor } if *own == joint => (joint, 1.0 / factor),
            Self::Order { of, order } if of.measurements() => (order[joint], 1.0),
            _ => (joint, 1.0),
        }
    }

    /// Factor of the positions and speeds of every joint.
    fn angle(&self) -> f64 {
        match self {
            Self::Degrees => 1_f64.to_radians(),
            Self::Turns => std::f64::consts::TAU,
            Self::Geared(ratio) => 1.0 / ratio,
            _ => 1.0,
        }
    }
}

/// The series of joints, each from a column by a factor.
fn read(columns: &[Vec<f64>], joint_as: impl Fn(usize) -> (usize, f64)) -> Vec<Vec<f64>> {
    let series = |(column, factor): (usize, f64)| columns[column].iter().map(|v| v * factor).collect();
    (0..columns.len()).map(|joint| series(joint_as(joint))).collect()
}

/// Takes a row from the same series elsewhere.
fn put(to: &mut [Vec<f64>], from: &[Vec<f64>], row: usize) {
    to.iter_mut().zip(from).for_each(|(to, from)| to[row] = from[row]);
}
