//! What calibrations and verdicts say on the terminal and in files.

pub mod essential;
pub mod metrics;
pub mod parameters;
pub mod position_bias;
pub mod robust;
pub mod shapes;
pub mod verdict;
