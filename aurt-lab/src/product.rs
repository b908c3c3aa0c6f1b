//! All that the laboratory takes from the product besides its simulator: errors, output files, and reading experiments.

pub use aurt::progress::{Observer, Progress};
pub use aurt_output::pretty;
pub use aurt_workbench::{
    failure::Failure,
    injected::plain,
    output::{OutputFile, OutputFolder},
};
