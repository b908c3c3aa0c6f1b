//! Model files: versioned JSON that people can read, for rigid bodies and for robot models before calibration.
//!
//! Every file is an object with `schema` (the version, [`SCHEMA`]) and `kind`. Friction models are saved under
//! their names with their keys, as in an experiment; those of dynamic libraries too, and the file then says under
//! `plugins` which libraries it needs. Reading therefore goes through a [`Registry`](crate::Registry), never directly
//! through serde.

mod base_parameters;
mod json;
mod rigid_body;
mod robot;

pub use self::base_parameters::{BaseParameterReading, read_base_parameters};
pub use self::json::read_json;
pub use self::rigid_body::{read_rigid_body, rigid_body_to_json};
pub use self::robot::{read_robot_model, robot_model_from_json, robot_model_to_json};

/// Version of the model files that this program writes and reads.
pub const SCHEMA: u64 = 1;

/// `kind` of files of rigid bodies.
pub const RIGID_BODY_DYNAMICS: &str = "rigid_body_dynamics";

/// `kind` of files of robot models before calibration.
pub const ROBOT_DYNAMICS: &str = "robot_dynamics";
