//! Effects that are in no vocabulary: a diagnosis that knows only the vocabulary has to say that something is there that
//! it does not know. One effect a file, as in `aurt_simulation::effects`; and what no experiment declares.

mod acceleration_friction;
mod cable_drag;
mod cross_drag;
mod known;
mod leaking_spring;
mod periodic_disturbance;
mod position_damper;
mod sticking_window;
mod undeclared;

pub use known::{all_kinds, kind, read_effect, unknown_effects};
pub use undeclared::{Lacks, NamedLack, PRESLIDING_RAD, Undeclared};
