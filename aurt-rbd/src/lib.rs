//! Rigid-body dynamics of chains and trees of revolute and prismatic joints on a fixed base.
//!
//! - [`MdhTable`] reads modified Denavit–Hartenberg parameters, [`SerialChain`] is the robot's geometry under
//!   gravity (of a table, or of general placements; a tree where joints name their [`Parent`]), with link frames and
//!   Jacobians.
//! - [`SerialChain`] implements [`aurt_traits::RigidBodyRegressor`], τ = Y(q, q̇, q̈) π: many samples a call,
//!   on the fastest instruction set that the processor has ([`aurt_traits::Dispatch`]).
//! - [`CoupledChain`] is a chain in which joints follow others, as a regressor in the coordinates that remain.
//! - [`base_parameters`] finds the minimal set of inertial parameters and what each of them collects.
//! - [`ChainDynamics`] adds values of the standard parameters: inverse and forward dynamics, mass matrix,
//!   bias torque, energy, one sample at a time.
//! - [`LinkBody`] converts mass, centre of mass and inertia; [`inconsistencies`] checks standard parameters.
//! - [`robots`] reads robots from URDF and MJCF files and knows common arms by name.
//!
//! Everywhere: joints count from 0, the standard parameters of a link are
//! {XX XY XZ YY YZ ZZ mX mY mZ m} in the link frame, inertia about its origin (the joint's centre of rotation),
//! link after link.
//!
//! ```
//! use aurt_rbd::{ChainDynamics, LinkBody, MdhRows, MdhTable, SerialChain, base_parameters};
//!
//! let table = MdhTable::parse("alpha,a,d\n0,0,0\n0,1,0\n", "two_link.csv", MdhRows::Next)?;
//! let chain = SerialChain::from_mdh(&table, [0.0, -9.81, 0.0])?;
//! let base = base_parameters(&chain, 0)?;
//! assert!(base.len() < 20);
//!
//! let rod = LinkBody { mass_kg: 1.0, com_m: [0.5, 0.0, 0.0], inertia_at_com_kg_m2: [1e-4, 0.0, 0.0, 0.08, 0.0, 0.08] };
//! let standard = [rod.standard_parameters(), rod.standard_parameters()].concat();
//! let mut dynamics = ChainDynamics::new(chain, &standard)?;
//! let mut torque_nm = [0.0; 2];
//! dynamics.inverse_dynamics(&[0.0; 2], &[0.0; 2], &[0.0; 2], &mut torque_nm);
//! assert!(torque_nm[0] > torque_nm[1] && torque_nm[1] > 0.0);
//! # Ok::<(), aurt_rbd::RbdError>(())
//! ```

mod angle;
mod base_parameters;
mod chain;
mod coupled;
mod description;
mod difference;
mod dynamics;
mod energy;
mod error;
mod forward_dynamics;
mod inertia;
mod joint;
mod kernel;
mod kinematics;
mod mass_matrix;
mod mdh;
mod plausible;
mod random;
mod regressor;
mod rnea;
pub mod robots;

pub use aurt_traits::Dispatch;
pub use base_parameters::{CarriedOver, Elimination, base_parameters, carry_over, eliminate};
pub use chain::SerialChain;
pub use coupled::{CoupledChain, Coupling};
pub use description::RobotDescription;
pub use difference::{GeometryDifference, geometry_difference};
pub use dynamics::ChainDynamics;
pub use energy::Energy;
pub use error::{MdhError, MdhErrors, RbdError};
pub use inertia::{Inconsistency, LinkBody, inconsistencies};
pub use joint::{Joint, JointKind, Parent, Placement};
pub use kinematics::LinkFrame;
pub use mdh::{MdhRow, MdhRows, MdhTable};
pub use plausible::{
    LARGEST_ANGLE_RAD, LARGEST_GRAVITY_M_S2, LONGEST_LINK_M, angle_complaint, gravity_complaint,
    length_complaint,
};

/// Number of standard inertial parameters of a link.
pub const INERTIAL_PARAMETERS: usize = 10;

pub use aurt_traits::MOST_JOINTS;
