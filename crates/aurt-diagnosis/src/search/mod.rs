//! Which hypotheses describe the recordings.

pub(crate) mod registered;
pub(crate) mod selection;

pub use selection::{Chosen, Selection, Selector};
