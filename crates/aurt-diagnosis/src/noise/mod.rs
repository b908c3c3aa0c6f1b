//! What noise alone leaves of a recording.

pub mod floor;
