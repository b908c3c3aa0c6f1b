//! What a recording is good for, before anyone calibrates on it.

pub mod excitation;
pub mod inspected;
pub mod joints;
pub mod judged;
pub mod series;
