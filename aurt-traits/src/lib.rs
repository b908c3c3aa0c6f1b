//! The vocabulary of AURT: what a friction model, a rigid body and a robot model are.
//!
//! A plugin author depends on this crate alone. It holds
//!
//! - the series that models receive: [`Motion`], [`MotionView`], [`JointSeries`], [`ArmSeries`];
//! - the traits of equation (6), τ_JD = f_C(τ_J)·H(z, q̇) + f_v(q̇): [`CoulombModel`], [`HysteresisModel`],
//!   [`ViscousBasis`], all of them [`JointModel`]s, and [`ArmTerm`] for physics outside that equation;
//! - [`RigidBodyRegressor`], the rigid bodies as a regressor in the standard inertial parameters;
//! - [`DriveModel`], from the command of a joint's drive to its torque, written in [`Jet`]s: values with derivatives;
//! - [`RobotModel`], which composes them into one regressor with named, unit-bearing parameters;
//! - [`ModelEntry`], the registration slot of statically linked models;
//! - [`Dispatch`], the instruction set that kernels run on.
//!
//! Joints count from 0. Units are SI; a model calibrated against motor currents has A in the place of Nm.

pub mod abi;
mod arm_term;
mod branch;
mod dispatch;
mod drive_model;
mod drive_numbers;
mod error;
mod invariants;
mod jet;
mod joint_model;
mod motion;
mod parameter;
mod registration;
mod rigid_body;
mod robot_model;
mod robot_names;
mod tile;

pub use arm_term::{ArmSeries, ArmTerm, InnerModels};
pub use branch::Branch;
pub use dispatch::Dispatch;
pub use drive_model::{Command, CommandSignal, DriveInput, DriveModel, DriveParameter, DriveTorque};
pub use drive_numbers::UNLIMITED;
pub use error::{ModelError, Result};
pub use invariants::{Invariant, Invariants};
pub use jet::Jet;
pub use joint_model::{CoulombModel, HysteresisModel, JointModel, JointStack, ViscousBasis};
pub use motion::{JointSeries, Motion, MotionView};
pub use parameter::{MeasurementUnit, Parameter, Scale, ShapeParameter};
pub use registration::{ModelEntry, Slot};
pub use rigid_body::{BaseParameters, RegressorTile, RigidBodyRegressor};
pub use robot_model::{ColumnGroup, KnownBodies, LoadTorque, RobotModel, RobotState, RobotTile};
pub use robot_names::RobotNames;
pub use tile::Columns;

/// Attribute macro that saves and reads a model behind its trait under a name: `#[typetag::serde(name = "…")]`.
pub use typetag;

/// What [`register_model!`] and plugin crates need from crates of others.
#[doc(hidden)]
pub mod reexport {
    pub use inventory;
    pub use typetag;
}

/// Joints of the largest chain or tree, those that follow others included: arms have up to about twenty, humanoids with
/// hands about a hundred, and the work for a model grows with the cube of their number.
pub const MOST_JOINTS: usize = 128;
