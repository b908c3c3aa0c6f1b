//! The program that compares the C functions with what the model itself predicts.

use std::fmt::Write;

use aurt_rbd::SerialChain;

use super::text::comment;
use crate::{
    ExportError, Source,
    program::{Check, TOLERANCE, list, literal, tables},
};

pub(super) fn program(
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
    let mut text = comment(&lines);
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
    let main = [("@NAME@", source.name), ("@TOLERANCE@", &literal(TOLERANCE)), ("@MEMORYLESS@", &memoryless)];
    text.push_str(&main.iter().fold(MAIN.to_owned(), |text, (mark, word)| text.replace(mark, word)));
    Ok(text)
}

const MAIN: &str = include_str!("harness_main.c");
