//! Files that other programs open.

#[cfg(feature = "mcap")]
mod mcap;
#[cfg(feature = "parquet")]
mod parquet;

#[cfg(feature = "mcap")]
pub use self::mcap::{JointTopic, mcap};
#[cfg(feature = "parquet")]
pub use self::parquet::parquet;
