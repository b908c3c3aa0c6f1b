//! Robot models put together: rigid bodies, the friction of each joint, arm terms; and the files that hold them.
//!
//! - [`Robot`] is a robot's geometry, from a table, a URDF or MJCF file, a name, or rigid bodies of one's own;
//! - [`Friction`] is the friction of a joint, [`ModelBuilder`] puts a model together;
//! - [`model_file`] writes and reads models as JSON.

mod builder;
mod error;
mod friction;
pub mod model_file;
mod place;
mod rigid_bodies;
mod robot;

pub use builder::ModelBuilder;
pub use error::Error;
pub use friction::Friction;
pub use place::Step;
pub use rigid_bodies::{BASE_PARAMETER_SEED, RigidBodyDynamics};
pub use robot::Robot;
