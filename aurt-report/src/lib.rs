//! What a person looks at: one self-contained HTML page, and every figure of it as SVG.
//!
//! This crate draws; it computes nothing of robots. It receives a [`Page`]: a verdict in words, sections of text,
//! tables and figures, and how all of it came about. The same drawing goes into the page and, with
//! [`Figure::to_svg`], into a file for a paper. A page needs no network and no other file, works without scripts, and
//! with them lets its figures be zoomed and moved.
//!
//! Text that comes from files and users is escaped in one place, `escape`; a test feeds it markup.

#![expect(missing_docs, reason = "the front ends are its only users; names that say all need no sentence")]

mod document;
mod escape;
mod figure;
pub mod glossary;
pub mod noise_report;
mod page;
pub mod rendering;
pub mod reports;
pub mod results;
mod table;
pub mod words;

pub use figure::{
    Arm, Axis, BarGroup, Bars, Figure, Layer, Mark, Panel, Plot, Shade, Style, Window, decimated,
    quantile_means, subsample,
};
pub use page::{Block, Page, Section, Tone, Verdict};
pub use table::{Cell, Table};
