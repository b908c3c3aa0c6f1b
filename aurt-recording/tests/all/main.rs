//! What the crate promises of recordings, in one program.
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

mod alignment;
mod clock;
mod csv_bad_input;
mod csv_formats;
mod ends;
mod filters;
#[cfg(all(feature = "matlab", feature = "mcap", feature = "numpy", feature = "parquet"))]
mod formats;
mod joined;
#[cfg(feature = "lerobot")]
mod lerobot;
mod logs;
mod long;
#[cfg(all(feature = "matlab", feature = "mcap", feature = "numpy", feature = "parquet"))]
mod memory;
mod recordings;
mod spread;
#[cfg(all(feature = "mcap", feature = "parquet"))]
mod written;
