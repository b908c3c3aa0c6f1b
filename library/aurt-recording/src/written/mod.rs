//! Writing series of numbers in formats that this crate reads: for plots and other programs.

mod mcap;
mod parquet;

pub use mcap::{JointTopic, mcap};
pub use parquet::parquet;
