//! A Rust crate: one source without dependencies, and a test that compares it with the model's own predictions.
//!
//! The functions are those of [`c`](crate::c), operation by operation. The source allocates nothing and has no `unsafe`;
//! without the feature `std` it is `no_std` and takes its functions from the crate `libm`.

mod text;

use std::fmt::Write;

use aurt_rbd::SerialChain;

use crate::c::RANGES;
use crate::naming::check_crate;
use crate::program::{self, Check, filled, list, tables};
use crate::{Export, ExportError, Source};

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
        ("tests/check.rs".to_owned(), check_program(source, chain, checks, program.memory.is_empty())?),
    ];
    Ok(Export { files, lost: vec![RANGES.into()], notes: program.costs("") })
}

/// The test that compares the crate with what the model itself predicts.
fn check_program(
    source: &Source<'_>,
    chain: &SerialChain,
    checks: &[Check],
    memoryless: bool,
) -> Result<String, ExportError> {
    let mut lines = vec![format!("Compares {} with values that the model itself predicts.", source.name)];
    lines.extend(source.provenance.lines());
    let mut text = text::comment("//!", &lines);
    let by_parts = if memoryless { MEMORYLESS } else { "" };
    text.push_str(&filled(MAIN, source, ("@MEMORYLESS@\n", by_parts)));
    for table in tables(source, chain, checks)? {
        let (rows, width) = (table.rows.len(), table.width);
        let _ = write!(text, "\nstatic {}: [[f64; {width}]; {rows}] = [\n", table.name.to_uppercase());
        for row in &table.rows {
            let _ = writeln!(text, "    [{}],", list(row));
        }
        text.push_str("];\n");
    }
    Ok(text)
}

const MAIN: &str = include_str!("check_main.rs");
const MEMORYLESS: &str = include_str!("check_memoryless.rs");
