//! Recordings longer than memory: parsed once into a temporary file, preprocessed stretch by stretch.

mod prepared;
mod recording;
mod spill;
mod uniform;

pub use prepared::{LongPrepared, LongSegment, Stretch};
pub use recording::LongRecording;
