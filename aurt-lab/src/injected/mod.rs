//! The world `injected`: recordings of a real robot, with an effect or as they are.

mod build;
mod make;
mod requests;

pub use requests::{InjectedRequest, InjectedWorld};
