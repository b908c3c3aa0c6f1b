//! Dry friction with memory, one model a file.

mod gms;
mod lugre;
mod masing;

pub use gms::Gms;
pub use lugre::LuGre;
pub use masing::Masing;
