//! The test that compares the crate with what the model itself predicts.

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
    let mut lines = vec![format!("Compares {} with values that the model itself predicts.", source.name)];
    lines.extend(source.provenance.lines());
    let mut text = comment("//!", &lines);
    let by_parts = if memoryless { MEMORYLESS } else { "" };
    let main = [("@NAME@", source.name), ("@TOLERANCE@", &literal(TOLERANCE)), ("@MEMORYLESS@\n", by_parts)];
    text.push_str(&main.iter().fold(MAIN.to_owned(), |text, (mark, word)| text.replace(mark, word)));
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
