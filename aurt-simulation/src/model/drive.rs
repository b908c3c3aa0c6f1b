//! What drives a model: torques that were measured, or a controller that follows a motion.

use aurt_traits::Motion;

use super::torque::Torque;
use crate::error::SimulationError;

#[derive(Debug, Clone, PartialEq)]
pub enum ModelDrive {
    /// Torques over time, linear between samples; the model starts where the motion does and goes where they
    /// take it.
    Torques {
        /// The motion, of which only times and first state are used.
        motion: Motion,
        /// `[joint][sample]`, in the unit that the model was calibrated in.
        torque: Vec<Vec<f64>>,
    },
    /// A controller that knows the model: what the model itself needs for the motion, and a
    /// proportional–derivative loop with the damping ratio 1.
    Follow { motion: Motion, bandwidth_hz: f64 },
}

impl ModelDrive {
    const fn motion(&self) -> &Motion {
        match self {
            Self::Torques { motion, .. } | Self::Follow { motion, .. } => motion,
        }
    }

    pub(super) fn joints(&self) -> usize {
        match self {
            Self::Torques { motion, torque } if torque.len() != motion.joints() => torque.len(),
            _ => self.motion().joints(),
        }
    }

    pub(super) fn time_s(&self) -> &[f64] {
        self.motion().view().time_s()
    }

    pub(super) fn start(&self) -> (Vec<f64>, Vec<f64>) {
        let view = self.motion().view();
        let first = |series: &[f64]| series.first().copied().unwrap_or(0.0);
        let joints = 0..view.joints();
        (
            joints.clone().map(|j| first(view.position_rad(j))).collect(),
            joints.map(|j| first(view.velocity_rad_s(j))).collect(),
        )
    }

    /// Proportional and derivative gain of each joint, for its inertia.
    pub(super) fn gains(&self, inertia: &[f64]) -> Vec<[f64; 2]> {
        let omega = match self {
            Self::Torques { .. } => 0.0,
            Self::Follow { bandwidth_hz, .. } => std::f64::consts::TAU * bandwidth_hz,
        };
        inertia.iter().map(|i| [i.abs() * omega * omega, 2.0 * i.abs() * omega]).collect()
    }

    pub(super) fn feed_forward(&self, torque: &mut Torque<'_>) -> Result<Vec<Vec<f64>>, SimulationError> {
        match self {
            Self::Torques { torque, .. } => Ok(torque.clone()),
            Self::Follow { motion, .. } => torque.along(motion),
        }
    }

    pub(super) fn commanded_rad(&self, time_s: f64, joint: usize) -> Option<f64> {
        match self {
            Self::Torques { .. } => None,
            Self::Follow { motion, .. } => Some(between(motion, time_s, joint).0),
        }
    }

    pub(super) fn torque(
        &self,
        time_s: f64,
        q: &[f64],
        v: &[f64],
        gains: &[[f64; 2]],
        feed_forward: &[Vec<f64>],
    ) -> Vec<f64> {
        let motion = self.motion();
        let (sample, share) = place(motion.view().time_s(), time_s);
        (0..q.len())
            .map(|j| {
                let series = &feed_forward[j];
                let next = series.get(sample + 1).copied().unwrap_or(series[sample]);
                let mut torque = series[sample] + share * (next - series[sample]);
                if let Self::Follow { motion, .. } = self {
                    let (commanded, velocity) = between(motion, time_s, j);
                    torque += gains[j][0] * (commanded - q[j]) + gains[j][1] * (velocity - v[j]);
                }
                torque
            })
            .collect()
    }
}

/// The sample at or before a time, and the share of the way to the next.
fn place(time_s: &[f64], at_s: f64) -> (usize, f64) {
    let last = time_s.len().saturating_sub(1);
    let sample = time_s.partition_point(|t| *t <= at_s).saturating_sub(1).min(last);
    match time_s.get(sample + 1) {
        Some(next) => (sample, ((at_s - time_s[sample]) / (next - time_s[sample])).clamp(0.0, 1.0)),
        None => (sample, 0.0),
    }
}

/// Angle and velocity between samples: the cubic through angles and velocities, and its derivative.
fn between(motion: &Motion, time_s: f64, joint: usize) -> (f64, f64) {
    let view = motion.view();
    let (sample, x) = place(view.time_s(), time_s);
    let (q, v) = (view.position_rad(joint), view.velocity_rad_s(joint));
    if sample + 1 >= q.len() {
        return (q[sample], v[sample]);
    }
    let h = view.time_s()[sample + 1] - view.time_s()[sample];
    let ([q0, q1], [v0, v1]) = ([q[sample], q[sample + 1]], [v[sample], v[sample + 1]]);
    let y = 1.0 - x;
    (
        q0 + (q1 - q0) * x * x * (3.0 - 2.0 * x) + h * (v0 * x * y * y - v1 * x * x * y),
        6.0 * x * y * (q1 - q0) / h + v0 * y * (1.0 - 3.0 * x) + v1 * x * (3.0 * x - 2.0),
    )
}
