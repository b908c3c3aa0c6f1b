//! Tables that commands leave behind in files.

pub mod diagnosed_series;
pub mod series;
pub mod sweep_table;
