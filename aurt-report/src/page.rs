//! What a report says, before it is drawn.

use crate::figure::Figure;
use crate::table::Table;

#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    /// What it is about, in the browser's title and at the top.
    pub title: String,
    pub verdict: Verdict,
    /// What supports it, most important first.
    pub sections: Vec<Section>,
    /// How it was computed: data, filters, versions, seeds; name and value.
    pub provenance: Vec<(String, String)>,
    /// The same results for programs, a JSON document; embedded, so that a report alone is enough to check it.
    pub results_json: String,
}

/// How good the news is; shown by a sign and a word as well as by colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tone {
    Good,
    Found,
    Attention,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    pub tone: Tone,
    pub headline: String,
    pub sentences: Vec<String>,
}

/// A part of a report under a heading.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    pub title: String,
    /// How to read what follows; may be empty.
    pub introduction: String,
    pub blocks: Vec<Block>,
}

impl Section {
    pub fn new(title: &str, introduction: impl Into<String>, blocks: Vec<Block>) -> Self {
        Self { title: title.to_owned(), introduction: introduction.into(), blocks }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    Text(String),
    List(Vec<String>),
    /// Text to be shown as it is written.
    Code(String),
    Table(Table),
    Figure(Figure),
    /// Figures side by side as far as there is room.
    Figures(Vec<Figure>),
    /// Blocks that can be folded away under a title, open or not at first.
    Folded {
        title: String,
        open: bool,
        blocks: Vec<Block>,
    },
}

impl Page {
    /// All figures in their order, each with a file name that no other has.
    pub fn figures(&self) -> Vec<(String, &Figure)> {
        let mut figures = Vec::new();
        for section in &self.sections {
            section.blocks.iter().for_each(|b| b.collect(&mut figures));
        }
        let mut taken = std::collections::BTreeSet::new();
        figures
            .into_iter()
            .map(|figure| {
                let stem = figure.name();
                let mut name = format!("{stem}.svg");
                let mut number = 2;
                while !taken.insert(name.clone()) {
                    name = format!("{stem}_{number}.svg");
                    number += 1;
                }
                (name, figure)
            })
            .collect()
    }
}

impl Block {
    fn collect<'p>(&'p self, found: &mut Vec<&'p Figure>) {
        match self {
            Self::Figure(figure) => found.push(figure),
            Self::Figures(figures) => found.extend(figures),
            Self::Folded { blocks, .. } => blocks.iter().for_each(|b| b.collect(found)),
            Self::Text(_) | Self::List(_) | Self::Code(_) | Self::Table(_) => {}
        }
    }
}
