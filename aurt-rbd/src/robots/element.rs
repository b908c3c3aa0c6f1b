//! Elements of XML files, with messages that say where they stand.

use std::path::Path;

use roxmltree::{Document, Node, ParsingOptions};

use crate::robots::RobotError;

/// Nodes of a file that are read; a humanoid has some ten thousand.
const MOST_NODES: u32 = 1 << 22;

/// The elements of a file.
pub(crate) fn document<'t>(text: &'t str, path: &Path) -> Result<Document<'t>, RobotError> {
    let options = ParsingOptions { nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|error| not_xml(&error, path))
}

fn not_xml(error: &roxmltree::Error, path: &Path) -> RobotError {
    let line = error.pos().row;
    match error {
        roxmltree::Error::UnknownNamespace(prefix, _) if prefix == "xacro" => {
            RobotError::Xacro { path: path.into(), line, text: "xacro:".into() }
        }
        roxmltree::Error::DtdDetected => RobotError::Xml {
            path: path.into(),
            line,
            reason:
                "the file declares a document type (<!DOCTYPE>), which could define entities without bound; \
                     remove the declaration"
                    .into(),
        },
        roxmltree::Error::NodesLimitReached => RobotError::Xml {
            path: path.into(),
            line,
            reason: format!("the file has more than {MOST_NODES} elements; that is no robot"),
        },
        _ => RobotError::Xml { path: path.into(), line, reason: format!("is no well-formed XML: {error}") },
    }
}

/// A file that is read, and where its lines begin: asked of the document itself, each place costs as much as all that
/// stands before it.
pub(crate) struct Source<'a> {
    pub path: &'a Path,
    line_starts: Vec<usize>,
}

impl<'a> Source<'a> {
    /// The file of an element.
    pub fn of(root: Node<'_, '_>, path: &'a Path) -> Self {
        let text = root.document().input_text();
        let after = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n').map(|(at, _)| at + 1);
        Self { path, line_starts: std::iter::once(0).chain(after).collect() }
    }

    /// The line that an element starts in, from 1.
    pub fn line(&self, node: Node<'_, '_>) -> u32 {
        let start = node.range().start;
        let line = self.line_starts.partition_point(|line| *line <= start);
        u32::try_from(line).unwrap_or(u32::MAX)
    }
}

/// An element with a name for messages, and a list for complaints about it.
pub(crate) struct Element<'a, 'x> {
    pub node: Node<'x, 'x>,
    /// The element as messages call it: `joint elbow`.
    pub what: String,
    pub source: &'a Source<'a>,
}

impl<'a, 'x> Element<'a, 'x> {
    pub fn line(&self) -> u32 {
        self.source.line(self.node)
    }

    /// The only or first child of a name.
    pub fn child(&self, name: &str) -> Option<Element<'a, 'x>> {
        let node = self.node.children().find(|c| c.is_element() && c.tag_name().name() == name)?;
        Some(Element { node, what: format!("{}, <{name}>", self.what), source: self.source })
    }

    /// A complaint about this element.
    pub fn error(&self, reason: impl Into<String>) -> RobotError {
        RobotError::Element {
            path: self.source.path.into(),
            line: self.line(),
            what: self.what.clone(),
            reason: reason.into(),
        }
    }

    /// An attribute that must be there.
    pub fn text(&self, attribute: &str) -> Result<&'x str, RobotError> {
        self.node.attribute(attribute).ok_or_else(|| self.error(format!("lacks the attribute `{attribute}`")))
    }

    /// An attribute of exactly `N` finite numbers, separated by spaces; `None` if it is not there.
    pub fn numbers<const N: usize>(&self, attribute: &str) -> Result<Option<[f64; N]>, RobotError> {
        self.node.attribute(attribute).map(|text| self.parsed(attribute, text)).transpose()
    }

    /// As [`Self::numbers`], of a text that the element has for the attribute from elsewhere.
    pub fn parsed<const N: usize>(&self, attribute: &str, text: &str) -> Result<[f64; N], RobotError> {
        let numbers: Option<Vec<f64>> =
            text.split_whitespace().map(|n| n.parse().ok().filter(|n: &f64| n.is_finite())).collect();
        let numbers: Option<[f64; N]> = numbers.and_then(|numbers| numbers.try_into().ok());
        match numbers {
            Some(numbers) => Ok(numbers),
            None if N == 1 => Err(self.error(format!("`{attribute}` must be a finite number, is `{text}`"))),
            None => Err(self
                .error(format!("`{attribute}` must be {N} finite numbers with spaces between, is `{text}`"))),
        }
    }

    /// An attribute of one finite number; `None` if it is not there.
    pub fn number(&self, attribute: &str) -> Result<Option<f64>, RobotError> {
        Ok(self.numbers::<1>(attribute)?.map(|[number]| number))
    }

    /// An attribute of one finite number that must be there.
    pub fn required(&self, attribute: &str) -> Result<f64, RobotError> {
        self.number(attribute)?.ok_or_else(|| self.error(format!("lacks the attribute `{attribute}`")))
    }
}
