//! Files that other programs open.

#[cfg(feature = "mcap")]
mod cdr;
#[cfg(feature = "lerobot")]
mod lerobot;
#[cfg(feature = "mcap")]
mod mcap;
#[cfg(feature = "parquet")]
mod parquet;
mod planned_motion;

#[cfg(feature = "mcap")]
pub use self::mcap::{JointTopic, mcap};
#[cfg(feature = "parquet")]
pub use self::parquet::parquet;
pub use self::planned_motion::PlannedMotion;
