//! Rows that are evaluated and filtered once and then shared.
//!
//! What a recording says of the rigid bodies does not depend on how friction is modelled. [`RigidRows`] holds the
//! filtered and decimated rows of the rigid-body columns of some recordings; [`FitRows`] holds, for a selection of
//! them, an orthonormal basis of these columns for each joint. A further model of joint dynamics then costs the
//! evaluation of its own columns, their filter, and their projection onto that basis:
//! with [Y_RBD | B | y] = [Q | Q′] · [R, QᵀB, Qᵀy; 0, S, s], only B, QᵀB and S are new.
//!
//! What hysteresis and viscous models give where they do not read the load torque is kept too, for all models that have
//! them.
//!
//! The results are those of [`calibrate`](crate::calibrate) and [`validate`](crate::validate()) to rounding.

mod dynamics;
mod fit;
mod fitting;
mod judging;
mod kept;
mod load;
mod parts;
mod rigid;
mod series;
mod stacks;

pub(crate) use dynamics::Source;
pub(crate) use fit::{Split, SplitColumn};
pub(crate) use fitting::{Fitted, fit};
pub(crate) use series::LoadSeries;

pub use fit::FitRows;
pub use judging::JudgedRow;
pub use rigid::RigidRows;
