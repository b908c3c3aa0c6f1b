//! All that the laboratory takes from the product besides its simulator: errors, output files, and reading experiments.

pub use aurt::progress::{Observer, Progress};
pub use aurt_experiment::workbench::failure::Failure;
pub use aurt_experiment::workbench::injected::plain;
pub use aurt_experiment::workbench::output::{OutputFile, OutputFolder};
pub use aurt_files::output::pretty;
