//! Which hypotheses describe the recordings.

pub(crate) mod ground;
mod recorded;
pub(crate) mod registered;
pub(crate) mod scoring;
pub(crate) mod selection;
pub(crate) mod shapes;

#[cfg(test)]
mod tests;

pub use ground::{Beside, Ground};
pub use selection::{Chosen, Selection, Selector};
