//! What calibrations and predictions leave behind: tables in files and on the terminal.

pub mod diagnosed_series;
pub mod essential;
pub mod metrics;
pub mod parameters;
pub mod position_bias;
pub mod predictions;
pub mod robust;
pub mod series;
pub mod shapes;
pub mod sweep_table;
pub mod verdict;
