//! C99: a header, a source, and a program that compares them with the model's own predictions.
//!
//! The source needs `math.h` alone, allocates nothing, and has no branch but those of the sign of velocity and of friction
//! with memory, whose state the caller keeps.

pub(crate) mod text;

use std::fmt::Write;

use aurt_rbd::SerialChain;

use crate::naming::check_identifier;
use crate::program::{self, Check, filled, list, tables};
use crate::{Export, ExportError, Source};

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
        ("main.c".to_owned(), check_program(source, chain, checks, program.memory.is_empty())?),
    ];
    let notes = program.costs(&format!("{name}_"));
    Ok(Export { files, lost: vec![RANGES.into()], notes })
}

/// What no source holds.
pub(crate) const RANGES: &str =
    "the load torques and velocities of the calibration, beyond which predictions extrapolate";

/// The program that compares the C functions with what the model itself predicts.
fn check_program(
    source: &Source<'_>,
    chain: &SerialChain,
    checks: &[Check],
    memoryless: bool,
) -> Result<String, ExportError> {
    let joints = chain.joints().len();
    let tables = tables(source, chain, checks)?;
    let mut lines = vec![
        format!("Compares {}.c with values that the model itself predicts.", source.name),
        format!(
            "cc -std=c99 -O2 {}.c main.c -lm -o check, then ./check: exit status 0 if all agree.",
            source.name
        ),
    ];
    lines.extend(source.provenance.lines());
    let mut text = text::comment(&lines);
    let _ = write!(
        text,
        "#include \"{}.h\"\n\n#include <math.h>\n#include <stdio.h>\n#include <string.h>\n\n",
        source.name
    );
    let [with_regressor, columns] = [tables[8].rows.len(), tables[8].width];
    let _ = write!(
        text,
        "#define JOINTS {joints}\n#define STATES {}\n#define WITH_REGRESSOR {with_regressor}\n#define ENTRIES {columns}\n\n",
        checks.len()
    );
    for table in &tables {
        let rows = if table.name == "regressor" { "WITH_REGRESSOR" } else { "STATES" };
        let _ = writeln!(text, "static const double {}[{rows}][{}] = {{", table.name, table.width);
        for row in &table.rows {
            let _ = writeln!(text, "    {{{}}},", list(row));
        }
        text.push_str("};\n\n");
    }
    let memoryless = u8::from(memoryless).to_string();
    text.push_str(&filled(MAIN, source, ("@MEMORYLESS@", &memoryless)));
    Ok(text)
}

const MAIN: &str = include_str!("harness_main.c");
