//! Elements of XML files, with messages that say where they stand.

use std::path::Path;

use roxmltree::{Document, Node, ParsingOptions};

use crate::robots::RobotError;

/// Nodes of a file that are read; a humanoid has some ten thousand.
const MOST_NODES: u32 = 1 << 20;
/// Attributes of an element that are read; the parser compares each with all others.
const MOST_ATTRIBUTES: usize = 128;
/// Declarations of namespaces that are read; each is handed down to all elements within.
const MOST_NAMESPACES: usize = 1000;
const MOST_NESTED: usize = 256;

pub(crate) fn document<'t>(text: &'t str, path: &Path) -> Result<Document<'t>, RobotError> {
    if let Some((at, reason)) = excess(text) {
        let line = u32::try_from(text[..at].matches('\n').count() + 1).unwrap_or(u32::MAX);
        return Err(RobotError::Xml {
            path: path.into(),
            line,
            reason: format!("{reason}; that is no robot"),
        });
    }
    let options = ParsingOptions { nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|error| not_xml(&error, path))
}

/// The first place at which a text has more of something than a robot has, before a parser takes time and memory for it.
/// What is no XML ends the search: the parser says so at the same place.
fn excess(text: &str) -> Option<(usize, String)> {
    let bytes = text.as_bytes();
    let (mut at, mut nodes, mut nested) = (0, 0, 0_usize);
    if text.matches("xmlns").nth(MOST_NAMESPACES).is_some() {
        return Some((0, format!("the file declares more than {MOST_NAMESPACES} namespaces")));
    }
    while let Some(begin) = text[at..].find('<').map(|begin| at + begin) {
        nodes += 1;
        if nodes > MOST_NODES {
            return Some((begin, format!("the file has more than {MOST_NODES} elements")));
        }
        let rest = &text[begin..];
        let other = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>"), ("</", ">")];
        if let Some((mark, end)) = other.into_iter().find(|(mark, _)| rest.starts_with(mark)) {
            nested = nested.saturating_sub(usize::from(mark == "</"));
            at = begin + mark.len() + rest[mark.len()..].find(end)? + end.len();
            continue;
        }
        let (mut attributes, mut quote) = (0, None);
        at = begin + 1;
        loop {
            match (*bytes.get(at)?, quote) {
                (byte, Some(open)) if byte == open => quote = None,
                (_, Some(_)) => {}
                (byte @ (b'"' | b'\''), None) => quote = Some(byte),
                (b'>', None) => break,
                (b'=', None) => attributes += 1,
                (_, None) => {}
            }
            at += 1;
        }
        if attributes > MOST_ATTRIBUTES {
            return Some((
                begin,
                format!("an element has {attributes} attributes, at most {MOST_ATTRIBUTES} are read"),
            ));
        }
        nested += usize::from(bytes[at - 1] != b'/');
        if nested > MOST_NESTED {
            return Some((begin, format!("elements are nested more than {MOST_NESTED} deep")));
        }
        at += 1;
    }
    None
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
