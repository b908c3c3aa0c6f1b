//! The functions of a model as straight lines of operations, in which constants are folded and nothing is computed that is
//! zero or is computed already. [`c`](crate::c) and [`rust`](crate::rust) print them. Bodies enter by their base
//! parameters, so every calibration can be written.

mod arm_terms;
mod checks;
mod description;
mod friction;
mod functions;
mod language;
mod memory;
mod newton_euler;
mod tape;
mod tunable;

pub use self::checks::Check;
pub(crate) use self::checks::{filled, tables};
pub(crate) use self::functions::{Body, Function, Program, all, tunable_step};
pub(crate) use self::language::{Language, list, literal};
pub(crate) use self::tunable::Tunable;
