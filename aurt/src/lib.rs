//! Model, calibrate and explain the dynamics of robot manipulators from recordings of the real machine.
//!
//! | verb | with |
//! |---|---|
//! | read | [`Recording::read`](recording::Recording::read), [`Recording::from_arrays`](recording::Recording::from_arrays), [`Robot::read_urdf`], [`Robot::from_mdh`], [`Robot::by_name`] |
//! | model | [`Robot::model`], [`Friction`], one stack per joint possible; models of one's own by the [`traits`] |
//! | calibrate | [`Calibrator`] |
//! | predict | [`CalibratedModel::torque`], [`predict`](CalibratedModel::predict), sample by sample [`Predictor`] |
//! | diagnose | [`Diagnoser`] |
//! | simulate | [`simulate`] |
//!
//! # Calibrating arrays, with the friction of each joint
//!
//! ```
//! use aurt::{prelude::*, simulation::{Motion, Scenario, robots}, simulate};
//!
//! // A simulated robot stands for the real one: it moves, and its logger records.
//! let machine = robots::two_link();
//! let motion = Motion::MultiSine { duration_s: 10.0, harmonics: 6, top_hz: 1.0, share: 0.6 };
//! let logged = simulate(&Scenario::new(machine.clone(), motion.plan(&machine, 1)?, 1))?;
//! let (time_s, position_rad, torque_nm) = (logged.time_s, logged.position_rad, logged.measurement.unwrap());
//!
//! let recording = Recording::from_arrays(time_s, position_rad)?
//!     .with_measurement(torque_nm, MeasurementUnit::NewtonMetre)?;
//! let robot = Robot::from_mdh(&machine.mdh_csv(), machine.gravity_m_s2)?;
//! let model = robot
//!     .model()
//!     .friction(Friction::coulomb().viscous(1))
//!     .joint_friction(1, Friction::load_dependent().viscous(2))
//!     .arm_term(RotorInertia { joints: JointSelection::of(vec![1]) })
//!     .build()?;
//! let model = Calibrator::new(model).calibration(&recording).calibrate()?.calibrated;
//! let mut predictor = model.predictor()?;
//! let torque = predictor.torque(0.0, &[0.1, 0.2], &[0.0, 0.0], &[0.0, 0.0])?;
//! assert_eq!(torque.len(), 2);
//! # Ok::<(), aurt::Error>(())
//! ```
//!
//! # What has changed?
//!
//! [`Diagnoser`] has an example with settings.
//!
//! # Rigid bodies of one's own
//!
//! Whatever gives τ = Y(q, q̇, q̈) π is a robot: calibration, prediction and diagnosis ask no more of it.
//!
//! ```
//! use std::sync::Arc;
//!
//! use aurt::{prelude::*, traits::{Parameter, RegressorTile, RigidBodyRegressor, typetag}};
//! use serde::{Deserialize, Serialize};
//!
//! /// A pendulum: τ = I q̈ + g m_c sin q.
//! #[derive(Debug, Clone, Serialize, Deserialize)]
//! struct Pendulum {}
//!
//! #[typetag::serde(name = "pendulum")]
//! impl RigidBodyRegressor for Pendulum {
//!     fn joints(&self) -> usize {
//!         1
//!     }
//!
//!     fn standard_parameters(&self) -> Vec<Parameter> {
//!         vec![Parameter::new("I", "kg m^2"), Parameter::new("m_c", "kg m")]
//!     }
//!
//!     fn loads(&self, _parameter: usize, _joint: usize) -> bool {
//!         true
//!     }
//!
//!     fn evaluate(&self, motion: MotionView<'_>, out: &mut RegressorTile<'_>) {
//!         if let Some(inertia) = out.entry_mut(0, 0) {
//!             inertia.copy_from_slice(motion.acceleration_rad_s2(0));
//!         }
//!         if let Some(weight) = out.entry_mut(0, 1) {
//!             weight.iter_mut().zip(motion.position_rad(0)).for_each(|(w, q)| *w = 9.81 * q.sin());
//!         }
//!     }
//!
//!     fn gravity_m_s2(&self) -> [f64; 3] {
//!         [0.0, -9.81, 0.0]
//!     }
//!
//!     fn with_gravity(&self, _gravity_m_s2: [f64; 3]) -> Box<dyn RigidBodyRegressor> {
//!         Box::new(self.clone())
//!     }
//! }
//!
//! let time_s: Vec<f64> = (0..4000).map(|k| 0.002 * f64::from(k)).collect();
//! let q: Vec<f64> = time_s.iter().map(|t| (3.0 * t).sin() + 0.5 * (7.0 * t).sin()).collect();
//! let qdd: Vec<f64> = time_s.iter().map(|t| -9.0 * (3.0 * t).sin() - 24.5 * (7.0 * t).sin()).collect();
//! let torque = q.iter().zip(&qdd).map(|(q, qdd)| 0.2 * qdd + 9.81 * 0.5 * q.sin()).collect();
//! let recording = Recording::from_arrays(time_s, vec![q])?
//!     .with_measurement(vec![torque], MeasurementUnit::NewtonMetre)?;
//!
//! let model = Robot::of_bodies(Arc::new(Pendulum {}))?.model().friction(Friction::absent()).build()?;
//! let model = Calibrator::new(model).calibration(&recording).calibrate()?.calibrated;
//! let standing = model.predictor()?.torque(0.0, &[0.1], &[0.0], &[0.0])?[0];
//! assert!((standing - 9.81 * 0.5 * 0.1_f64.sin()).abs() < 0.01, "{standing}");
//! # Ok::<(), aurt::Error>(())
//! ```
//!
//! # Features
//!
//! | feature | what it adds |
//! |---|---|
//! | `export` | [`export`]: models as files of other programs |
//! | `simulation` | [`simulation`] and [`simulate`]: simulated robots, calibrated models that move |
//!
//! Both are on unless `default-features = false`.
//!
//! # Conventions
//!
//! Every fallible function returns [`Error`] or the error of the crate that it is from, which becomes one. Joints count from
//! 0, units are SI and stand in names; a model calibrated on motor currents has A in the place of Nm.
//! [`plugins`] loads models from dynamic libraries.

#![cfg_attr(docsrs, feature(doc_cfg))]

mod calibrated_file;
mod calibrating;
pub mod data;
mod diagnoser;
pub mod duplicates;
pub mod effects;
mod equation_of_motion;
mod error;
pub mod fitting;
mod likeness;
pub mod origins;
pub mod predictions;
mod predictor;
pub mod prelude;
pub mod progress;
mod questioned;
mod role;
#[cfg(feature = "simulation")]
mod simulating;
mod torque;

pub use aurt_calibration as calibration;
pub use aurt_diagnosis as diagnosis;
#[cfg(feature = "export")]
pub use aurt_export as export;
pub use aurt_friction as friction;
pub use aurt_plugins as plugins;
pub use aurt_plugins::model;
pub use aurt_recording as recording;
#[cfg(feature = "simulation")]
pub use aurt_simulation as simulation;
pub use aurt_traits as traits;

pub use crate::calibrated_file::{CalibratedModel, file_contents};
pub use crate::calibrating::{Calibrator, Settings};
pub use crate::diagnoser::{Diagnoser, Diagnosis, Explanation, is_found};
pub use crate::effects::{Effect, EffectKind};
pub use crate::equation_of_motion::EquationOfMotion;
pub use crate::error::Error;
pub use crate::fitting::Outcome;
pub use crate::predictor::Predictor;
pub use crate::progress::Progress;
pub use crate::questioned::{Asked, Part};
pub use crate::role::{RecordingResult, Role};
#[cfg(feature = "simulation")]
pub use crate::simulating::{Drive, simulate};
pub use crate::torque::TorqueSeries;
pub use aurt_plugins::model::{Friction, ModelBuilder, Robot};
