//! C99: a header, a source, and a program that compares them with the model's own predictions.
//!
//! The source needs `math.h` alone, allocates nothing, and has no branch but those of the sign of velocity and of friction
//! with memory, whose state the caller keeps. Every function is a straight line of operations, in which constants are folded and nothing is computed that is
//! zero or is computed already. Bodies enter by their base parameters, so every calibration can be exported.

mod arm_terms;
mod friction;
pub(crate) mod functions;
mod harness;
mod memory;
mod newton_euler;
mod tape;
pub(crate) mod text;
pub(crate) mod tunable;

pub use tape::Operations;
pub(crate) use tape::literal;

pub use self::harness::Check;
use crate::{Export, ExportError, Source, naming::check_identifier};

/// The C of a model, with a program that compares it with `checks`.
///
/// # Errors
/// Names that C cannot have; models that cannot be written, by their names; models in amperes.
pub fn export(source: &Source<'_>, checks: &[Check]) -> Result<Export, ExportError> {
    check_identifier(source.name)?;
    let chain = source.chain()?;
    let program = functions::all(source, chain)?;
    let name = source.name;
    let files = vec![
        (format!("{name}.h"), text::header(source, chain, &program, None)),
        (format!("{name}.c"), text::implementation(source, &program)),
        ("main.c".to_owned(), harness::program(source, chain, checks, program.memory.is_empty())?),
    ];
    let notes = program
        .functions
        .iter()
        .filter(|f| f.operations != Operations::default())
        .map(|f| {
            let Operations { multiplications, additions, calls } = f.operations;
            format!(
                "{name}_{}: {multiplications} multiplications, {additions} additions, {calls} calls",
                f.name
            )
        })
        .collect();
    let lost = vec![
        "the load torques and velocities of the calibration, beyond which predictions extrapolate".into(),
    ];
    Ok(Export { files, lost, notes })
}
