//! A Rust crate: one source without dependencies, and a test that compares it with the model's own predictions.
//!
//! The functions are those of [`c`](crate::c), operation by operation. The source allocates nothing and has no `unsafe`;
//! without the feature `std` it is `no_std` and takes its functions from the crate `libm`.

mod harness;
mod text;

use crate::{
    Export, ExportError, Source,
    c::RANGES,
    naming::check_crate,
    program::{self, Check},
};

/// The crate of a model, with a test that compares it with `checks`.
///
/// # Errors
/// Names that a crate cannot have; models that cannot be written, by their names; models in amperes.
pub fn export(source: &Source<'_>, checks: &[Check]) -> Result<Export, ExportError> {
    check_crate(source.name)?;
    let chain = source.chain()?;
    let program = program::all(source, chain)?;
    let files = vec![
        ("Cargo.toml".to_owned(), text::manifest(source)),
        ("src/lib.rs".to_owned(), text::library(source, chain, &program)),
        ("tests/check.rs".to_owned(), harness::program(source, chain, checks, program.memory.is_empty())?),
    ];
    Ok(Export { files, lost: vec![RANGES.into()], notes: program.costs("") })
}
