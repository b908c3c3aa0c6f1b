//! Pages of sweeps, sensitivities and tracked machines.

pub mod sensitivity;
pub mod sweep;
pub mod track;

use aurt_report::{Block, Section};

/// A part of a page; the introduction says how to read what follows, and may be empty.
pub fn section(title: &str, introduction: &str, blocks: Vec<Block>) -> Section {
    Section { title: title.to_owned(), introduction: introduction.to_owned(), blocks }
}
