//! Commanded motions: functions of time that start and end at rest, within a robot's limits.

mod excitation;
mod formats;
mod mixed;
mod multi_sine;
mod point_to_point;
mod recorded;
mod sequence;
mod velocity_profile;

pub use excitation::{Excitation, ExcitationOptions, excite};
pub use multi_sine::MultiSineOptions;

use std::fmt::Debug;
use std::path::PathBuf;
use std::sync::Arc;

use aurt_rbd::ChainDynamics;
use serde::{Deserialize, Serialize};

use crate::error::SimulationError;
use crate::random::Random;
use crate::robots::Robot;

/// A twice differentiable function of time for all joints.
pub trait Path: Debug + Send + Sync {
    fn joints(&self) -> usize;

    /// Duration in s; before 0 and after it the path rests.
    fn duration_s(&self) -> f64;

    /// Writes angles (rad), velocities (rad/s) and accelerations (rad/s²) at `time_s`, N each.
    fn at(&self, time_s: f64, q_rad: &mut [f64], qd_rad_s: &mut [f64], qdd_rad_s2: &mut [f64]);
}

/// A commanded motion; cheap to copy.
#[derive(Debug, Clone)]
pub struct Trajectory(Arc<dyn Path>);

/// What kind of motion to make, and how long.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Motion {
    /// Band-limited sums of sines on all joints, periodic between the ramps at both ends.
    MultiSine {
        /// Duration in s, ramps and rests included.
        duration_s: f64,
        /// Number of harmonics, 1–40 (5–12 are usual).
        harmonics: usize,
        /// Frequency of the highest harmonic, Hz.
        top_hz: f64,
        /// Share of the position, velocity and acceleration limits that may be used, (0, 1].
        share: f64,
    },
    /// Moves between random poses with rests between them.
    PointToPoint {
        duration_s: f64,
        /// Share of the velocity and acceleration limits that is used, (0, 1].
        share: f64,
        /// Rest at each pose, s.
        rest_s: f64,
    },
    /// Sums of sines, and after them moves between poses.
    Mixed {
        /// Duration in s, 15 or more.
        duration_s: f64,
        /// Number of harmonics of the sines, 1–40.
        harmonics: usize,
        /// Frequency of the highest harmonic, Hz.
        top_hz: f64,
        /// Share of the limits that may be used, (0, 1].
        share: f64,
        /// Rest at each pose, s.
        rest_s: f64,
    },
    /// Slow triangles of nested amplitudes on all joints, rich in reversals.
    Triangles {
        duration_s: f64,
        speed_rad_s: f64,
        /// Largest amplitude in rad; loops of down to a twentieth of it are nested in.
        amplitude_rad: f64,
    },
    /// Strokes back and forth at constant velocities up to a share of the limit.
    Sweeps {
        duration_s: f64,
        /// Share of the velocity limits that the fastest stroke uses, (0, 1].
        share: f64,
    },
    /// A motion that was planned or recorded.
    Recorded {
        /// A table with times and positions, with velocities or without; seen from the scenario's file.
        file: PathBuf,
    },
}

impl Motion {
    /// The trajectory of this kind that a seed gives for a robot.
    ///
    /// # Errors
    /// If an option makes no sense or the result leaves the robot's limits.
    pub fn plan(&self, robot: &Robot, seed: u64) -> Result<Trajectory, SimulationError> {
        let mut random = Random::labelled(seed, "trajectory");
        let trajectory = match *self {
            Self::Recorded { ref file } => recorded::read(file)?,
            Self::MultiSine { duration_s, harmonics, top_hz, share } => {
                let options = MultiSineOptions { duration_s, harmonics, top_hz, share };
                multi_sine::draw(robot, &options, &mut random)?
            }
            Self::PointToPoint { duration_s, share, rest_s } => {
                point_to_point::draw(robot, duration_s, share, rest_s, &mut random)?
            }
            Self::Mixed { duration_s, harmonics, top_hz, share, rest_s } => {
                let sines = MultiSineOptions { duration_s, harmonics, top_hz, share };
                mixed::draw(robot, &sines, rest_s, &mut random)?
            }
            Self::Triangles { duration_s, speed_rad_s, amplitude_rad } => {
                velocity_profile::triangles(robot, duration_s, speed_rad_s, amplitude_rad, &mut random)?
            }
            Self::Sweeps { duration_s, share } => {
                velocity_profile::sweeps(robot, duration_s, share, &mut random)?
            }
        };
        trajectory.check(robot)?;
        Ok(trajectory)
    }
}

/// Distance of the samples at which limits are checked, s.
const CHECK_EVERY_S: f64 = 0.005;
/// Rounding that a limit forgives, relative.
const LIMIT_SLACK: f64 = 1e-9;

impl Trajectory {
    /// A trajectory along any path.
    pub fn new(path: impl Path + 'static) -> Self {
        Self(Arc::new(path))
    }

    pub fn joints(&self) -> usize {
        self.0.joints()
    }

    pub fn duration_s(&self) -> f64 {
        self.0.duration_s()
    }

    /// Writes angles (rad), velocities (rad/s) and accelerations (rad/s²) at `time_s`, N each.
    pub fn at(&self, time_s: f64, q_rad: &mut [f64], qd_rad_s: &mut [f64], qdd_rad_s2: &mut [f64]) {
        self.0.at(time_s.clamp(0.0, self.duration_s()), q_rad, qd_rad_s, qdd_rad_s2);
    }

    /// Checks position, velocity and acceleration against the robot's limits, every 5 ms.
    ///
    /// # Errors
    /// [`SimulationError::Count`] for another number of joints, [`SimulationError::BeyondLimit`] with the
    /// worst violation of every joint and quantity.
    pub fn check(&self, robot: &Robot) -> Result<(), SimulationError> {
        let joints = robot.joints();
        if self.joints() != joints {
            return Err(SimulationError::count(
                format!("joints of the trajectory for {}", robot.name),
                joints,
                self.joints(),
            ));
        }
        let mut worst: Vec<[Option<(f64, SimulationError)>; 3]> =
            (0..joints).map(|_| [const { None }; 3]).collect();
        self.sample(|time_s, q, qd, qdd| {
            for (joint, drive) in robot.drives.iter().enumerate() {
                let [low, high] = drive.position_limit_rad;
                let (limit, room) = if q[joint] > high { (high, 1.0) } else { (low, -1.0) };
                let checks = [
                    ("position", "rad", q[joint], limit, room * (q[joint] - limit)),
                    (
                        "velocity",
                        "rad/s",
                        qd[joint],
                        drive.velocity_limit_rad_s,
                        qd[joint].abs() - drive.velocity_limit_rad_s,
                    ),
                    (
                        "acceleration",
                        "rad/s^2",
                        qdd[joint],
                        drive.acceleration_limit_rad_s2,
                        qdd[joint].abs() - drive.acceleration_limit_rad_s2,
                    ),
                ];
                for (slot, (quantity, unit, value, limit, excess)) in worst[joint].iter_mut().zip(checks) {
                    // Written so that a NaN is a violation too.
                    let within = excess <= LIMIT_SLACK * limit.abs();
                    let worse = slot.as_ref().is_none_or(|(before, _)| excess > *before);
                    if !within && worse {
                        let error =
                            SimulationError::BeyondLimit { joint, quantity, unit, value, limit, time_s };
                        *slot = Some((excess, error));
                    }
                }
            }
        });
        SimulationError::all(worst.into_iter().flatten().flatten().map(|(_, error)| error).collect())
    }

    /// Checks the torques that the robot's nominal model needs against its drives' limits, every 5 ms.
    ///
    /// # Errors
    /// [`SimulationError::BeyondLimit`], and whatever the rigid bodies say.
    pub fn check_torque(&self, robot: &Robot) -> Result<(), SimulationError> {
        let rotors: Vec<f64> = robot.drives.iter().map(|d| d.rotor_inertia_kg_m2).collect();
        let mut dynamics =
            ChainDynamics::new(robot.chain()?, &robot.standard_parameters())?.with_rotor_inertia(&rotors)?;
        let mut torque = vec![0.0; robot.joints()];
        let mut worst: Vec<Option<SimulationError>> = (0..robot.joints()).map(|_| None).collect();
        let mut excess = vec![0.0; robot.joints()];
        self.sample(|time_s, q, qd, qdd| {
            dynamics.inverse_dynamics(q, qd, qdd, &mut torque);
            for (joint, drive) in robot.drives.iter().enumerate() {
                let direction = if qd[joint] == 0.0 { 0.0 } else { qd[joint].signum() };
                let friction = (drive.coulomb_nm + drive.load_coefficient * torque[joint].abs()) * direction
                    + drive.viscous_nm_s * qd[joint];
                let value = torque[joint] + friction;
                let over = value.abs() - drive.torque_limit_nm;
                if over > excess[joint] {
                    excess[joint] = over;
                    worst[joint] = Some(SimulationError::BeyondLimit {
                        joint,
                        quantity: "torque",
                        unit: "Nm",
                        value,
                        limit: drive.torque_limit_nm,
                        time_s,
                    });
                }
            }
        });
        SimulationError::all(worst.into_iter().flatten().collect())
    }

    /// Calls `visit` with time, angles, velocities and accelerations every 5 ms.
    fn sample(&self, mut visit: impl FnMut(f64, &[f64], &[f64], &[f64])) {
        let joints = self.joints();
        let (mut q, mut qd, mut qdd) = (vec![0.0; joints], vec![0.0; joints], vec![0.0; joints]);
        let samples = (self.duration_s() / CHECK_EVERY_S) as usize;
        for k in 0..=samples {
            let time_s = k as f64 * CHECK_EVERY_S;
            self.at(time_s, &mut q, &mut qd, &mut qdd);
            visit(time_s, &q, &qd, &qdd);
        }
    }
}

/// The step from 0 to 1 over [0, 1] with three vanishing derivatives at both ends, 35x⁴ − 84x⁵ + 70x⁶ − 20x⁷,
/// with its first and second derivative.
fn smooth_step(x: f64) -> [f64; 3] {
    if x <= 0.0 {
        return [0.0; 3];
    }
    if x >= 1.0 {
        return [1.0, 0.0, 0.0];
    }
    let (x2, y) = (x * x, 1.0 - x);
    let x3 = x2 * x;
    [
        x3 * x * (35.0 - 84.0 * x + 70.0 * x2 - 20.0 * x3),
        140.0 * x3 * y * y * y,
        420.0 * x2 * y * y * (1.0 - 2.0 * x),
    ]
}

/// Largest first derivative of [`smooth_step`], at 1/2.
const STEP_PEAK_VELOCITY: f64 = 2.1875;
/// Largest second derivative of [`smooth_step`], 84√5/25, at (1 − 1/√5)/2.
const STEP_PEAK_ACCELERATION: f64 = 7.513_188_404_399_293;

/// Rows of the longest motion that is written; an hour at 500 Hz.
const MOST_ROWS: f64 = 1.8e6;

/// Complains about a duration or share that makes no sense.
fn check_options(duration_s: f64, share: f64) -> Result<(), SimulationError> {
    let mut complaints = crate::error::Complaints::default();
    complaints.within("duration of the trajectory in s", duration_s, 1.0, 3600.0);
    complaints.within("share of the limits", share, 1e-3, 1.0);
    complaints.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robots;

    pub(super) fn motions() -> Vec<Motion> {
        vec![
            Motion::MultiSine { duration_s: 30.0, harmonics: 8, top_hz: 0.8, share: 0.7 },
            Motion::PointToPoint { duration_s: 30.0, share: 0.5, rest_s: 0.5 },
            Motion::Mixed { duration_s: 30.0, harmonics: 6, top_hz: 1.0, share: 0.5, rest_s: 0.5 },
            Motion::Triangles { duration_s: 30.0, speed_rad_s: 0.15, amplitude_rad: 0.4 },
            Motion::Sweeps { duration_s: 30.0, share: 0.6 },
        ]
    }

    #[test]
    fn step_and_its_peaks() {
        let peak = |k: usize| (0..=1000).map(|i| smooth_step(f64::from(i) / 1000.0)[k]).fold(0.0, f64::max);
        assert!(
            (peak(1) - STEP_PEAK_VELOCITY).abs() < 1e-5 && (peak(2) - STEP_PEAK_ACCELERATION).abs() < 1e-4
        );
        assert_eq!(smooth_step(0.5)[0], 0.5);
    }

    /// Velocity and acceleration are the derivatives of position; both ends rest.
    #[test]
    fn every_motion_of_every_robot_is_consistent() {
        for robot in Robot::all() {
            for motion in motions() {
                let trajectory = motion.plan(&robot, 3).unwrap();
                trajectory.check_torque(&robot).unwrap();
                let n = robot.joints();
                let at = |t: f64| {
                    let (mut q, mut v, mut a) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
                    trajectory.at(t, &mut q, &mut v, &mut a);
                    (q, v, a)
                };
                for t in [0.0, trajectory.duration_s()] {
                    let (_, v, a) = at(t);
                    assert!(v.iter().chain(&a).all(|x| x.abs() < 1e-9), "{motion:?} {} {t}", robot.name);
                }
                let h = 1e-5;
                for k in 0..200 {
                    let t = 0.2 + 0.1473 * f64::from(k);
                    let ((q0, v0, _), (q1, v1, _), (_, v, a)) = (at(t - h), at(t + h), at(t));
                    for j in 0..n {
                        let (dq, dv) = ((q1[j] - q0[j]) / (2.0 * h), (v1[j] - v0[j]) / (2.0 * h));
                        assert!((dq - v[j]).abs() < 1e-5, "{motion:?} {t}: {dq} {}", v[j]);
                        assert!((dv - a[j]).abs() < 2e-2, "{motion:?} {t}: {dv} {}", a[j]);
                    }
                }
            }
        }
    }

    #[test]
    fn the_seed_decides() {
        let robot = robots::ur10e();
        for motion in motions() {
            let position = |seed| {
                let mut q = vec![0.0; 6];
                motion.plan(&robot, seed).unwrap().at(7.7, &mut q, &mut [0.0; 6], &mut [0.0; 6]);
                q
            };
            assert_eq!(position(1), position(1));
            assert_ne!(position(1), position(2), "{motion:?}");
        }
    }

    #[test]
    fn limits_are_limits() {
        let motion = Motion::MultiSine { duration_s: 20.0, harmonics: 6, top_hz: 0.6, share: 1.0 };
        let mut robot = robots::ur10e();
        let trajectory = motion.plan(&robot, 1).unwrap();
        robot.drives[3].velocity_limit_rad_s *= 0.2;
        let text = trajectory.check(&robot).unwrap_err().to_string();
        assert!(text.contains("joint 3") && text.contains("velocity"), "{text}");
        let bad = Motion::MultiSine { duration_s: 20.0, harmonics: 0, top_hz: -1.0, share: 2.0 };
        assert!(bad.plan(&robots::ur10e(), 1).is_err());
    }
}
