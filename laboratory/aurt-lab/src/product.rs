//! All that the laboratory takes from the product besides its simulator: errors, output files, and reading experiments.

pub use aurt::{
    Error as Failure,
    injected::plain,
    output::{OutputFile, OutputFolder},
    progress::{Observer, Progress},
    rendering::json::pretty,
};
