//! Rows of recordings: evaluated, filtered, decimated.

mod accumulate;
mod joint_rows;
mod pieces;
mod recordings;
mod scope;
mod stream;

pub(crate) use accumulate::{Accumulated, Folding, Measured, accumulate_ranged};
pub(crate) use joint_rows::JointRows;
pub(crate) use pieces::{Observed, Piece};
pub(crate) use recordings::{check, ranges};
pub(crate) use stream::TILE_SAMPLES;

pub use accumulate::accumulate;
pub use recordings::{JointRange, NamedRecording};
pub use scope::TermScopes;
pub use stream::{RowBlock, for_each_predicted_block, for_each_row_block, for_each_tile, predict_tile};
