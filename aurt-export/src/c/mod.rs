//! C99: a header, a source, and a program that compares them with the model's own predictions.
//!
//! The source needs `math.h` alone, allocates nothing, and has no branch but those of the sign of velocity and of friction
//! with memory, whose state the caller keeps.

mod harness;
pub(crate) mod text;

use crate::{
    Export, ExportError, Source,
    naming::check_identifier,
    program::{self, Check},
};

/// The C of a model, with a program that compares it with `checks`.
///
/// # Errors
/// Names that C cannot have; models that cannot be written, by their names; models in amperes.
pub fn export(source: &Source<'_>, checks: &[Check]) -> Result<Export, ExportError> {
    check_identifier(source.name)?;
    let chain = source.chain()?;
    let program = program::all(source, chain)?;
    let name = source.name;
    let files = vec![
        (format!("{name}.h"), text::header(source, chain, &program, None)),
        (format!("{name}.c"), text::implementation(source, &program)),
        ("main.c".to_owned(), harness::program(source, chain, checks, program.memory.is_empty())?),
    ];
    let notes = program.costs(&format!("{name}_"));
    Ok(Export { files, lost: vec![RANGES.into()], notes })
}

/// What no source holds.
pub(crate) const RANGES: &str =
    "the load torques and velocities of the calibration, beyond which predictions extrapolate";
