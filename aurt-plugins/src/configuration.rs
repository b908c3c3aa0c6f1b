//! A value of an experiment together with the place where it was written.

use std::ops::Range;

use serde_json::{Map, Value};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Byte range in the text that a value was read from; empty for values that were not read from a text.
pub type Span = Range<usize>;

/// A value with its place.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// What it is.
    pub kind: NodeKind,
    /// Where it stands; for a table, its header or its braces.
    pub span: Span,
}

/// The kinds of values of TOML, and the absent value of JSON.
#[derive(Debug, Clone, PartialEq)]
pub enum NodeKind {
    /// `null`, which only saved models have.
    Null,
    /// `true` or `false`.
    Boolean(bool),
    /// A whole number.
    Integer(i64),
    /// Any other number, `inf` and `nan` included.
    Float(f64),
    /// A string.
    String(String),
    /// A date or time, as it is written.
    Datetime(String),
    /// A list.
    Array(Vec<Node>),
    /// A table, in the order of writing.
    Table(Vec<Entry>),
}

/// A key with its value.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// The key.
    pub key: String,
    /// Where the key stands.
    pub key_span: Span,
    /// The value.
    pub value: Node,
}

impl Node {
    /// A value that was not read from a text.
    pub const fn new(kind: NodeKind) -> Self {
        Self { kind, span: 0..0 }
    }

    /// The kind of the value in words, for "expected …, found …".
    pub const fn kind_name(&self) -> &'static str {
        match self.kind {
            NodeKind::Null => "null",
            NodeKind::Boolean(_) => "a boolean",
            NodeKind::Integer(_) => "an integer",
            NodeKind::Float(_) => "a number",
            NodeKind::String(_) => "a string",
            NodeKind::Datetime(_) => "a date or time",
            NodeKind::Array(_) => "a list",
            NodeKind::Table(_) => "a table",
        }
    }

    /// The entries of a table; none for anything else.
    pub fn entries(&self) -> &[Entry] {
        match &self.kind {
            NodeKind::Table(entries) => entries,
            _ => &[],
        }
    }

    /// The entry of a key, if the value is a table that has it.
    pub fn entry(&self, key: &str) -> Option<&Entry> {
        self.entries().iter().find(|e| e.key == key)
    }

    /// The value of a key, if the value is a table that has it.
    pub fn get(&self, key: &str) -> Option<&Self> {
        self.entry(key).map(|e| &e.value)
    }

    /// The text of a string.
    pub fn as_str(&self) -> Option<&str> {
        match &self.kind {
            NodeKind::String(text) => Some(text),
            _ => None,
        }
    }

    /// The value of a number, whole or not.
    pub const fn as_number(&self) -> Option<f64> {
        match self.kind {
            NodeKind::Integer(n) => Some(n as f64),
            NodeKind::Float(x) => Some(x),
            _ => None,
        }
    }

    /// The value as JSON; dates become strings, `inf` and `nan` become `null`.
    pub fn to_json(&self) -> Value {
        match &self.kind {
            NodeKind::Null => Value::Null,
            NodeKind::Boolean(b) => Value::from(*b),
            NodeKind::Integer(n) => Value::from(*n),
            NodeKind::Float(x) => Value::from(*x),
            NodeKind::String(text) | NodeKind::Datetime(text) => Value::from(text.as_str()),
            NodeKind::Array(list) => Value::Array(list.iter().map(Self::to_json).collect()),
            NodeKind::Table(entries) => Value::Object(
                entries.iter().map(|e| (e.key.clone(), e.value.to_json())).collect::<Map<_, _>>(),
            ),
        }
    }

    /// The places of numbers in the value that are not finite.
    pub(crate) fn not_finite(&self) -> Vec<Span> {
        match &self.kind {
            NodeKind::Float(x) if !x.is_finite() => vec![self.span.clone()],
            NodeKind::Array(list) => list.iter().flat_map(Self::not_finite).collect(),
            NodeKind::Table(entries) => entries.iter().flat_map(|e| e.value.not_finite()).collect(),
            _ => Vec::new(),
        }
    }

    /// A parsed TOML table, and the numbers in it that no `i64` or `f64` can hold.
    pub fn from_toml(table: &DeTable<'_>, span: Span) -> (Self, Vec<Span>) {
        let mut unreadable = Vec::new();
        let node = Self { kind: table_kind(table, &mut unreadable), span };
        (node, unreadable)
    }
}

impl From<&Value> for Node {
    /// A JSON value, without places.
    fn from(value: &Value) -> Self {
        Self::new(match value {
            Value::Null => NodeKind::Null,
            Value::Bool(b) => NodeKind::Boolean(*b),
            Value::Number(n) => {
                n.as_i64().map_or_else(|| NodeKind::Float(n.as_f64().unwrap_or(f64::NAN)), NodeKind::Integer)
            }
            Value::String(text) => NodeKind::String(text.clone()),
            Value::Array(list) => NodeKind::Array(list.iter().map(Self::from).collect()),
            Value::Object(map) => NodeKind::Table(
                map.iter()
                    .map(|(key, value)| Entry { key: key.clone(), key_span: 0..0, value: Self::from(value) })
                    .collect(),
            ),
        })
    }
}

fn table_kind(table: &DeTable<'_>, unreadable: &mut Vec<Span>) -> NodeKind {
    NodeKind::Table(
        table
            .iter()
            .map(|(key, value)| Entry {
                key: key.get_ref().to_string(),
                key_span: key.span(),
                value: node(value, unreadable),
            })
            .collect(),
    )
}

fn node(value: &Spanned<DeValue<'_>>, unreadable: &mut Vec<Span>) -> Node {
    let kind = match value.get_ref() {
        DeValue::Boolean(b) => NodeKind::Boolean(*b),
        DeValue::Integer(n) => i64::from_str_radix(n.as_str(), n.radix()).map_or_else(
            |_| {
                unreadable.push(value.span());
                NodeKind::Integer(0)
            },
            NodeKind::Integer,
        ),
        DeValue::Float(x) => NodeKind::Float(x.as_str().parse().unwrap_or_else(|_| {
            unreadable.push(value.span());
            0.0
        })),
        DeValue::String(text) => NodeKind::String(text.to_string()),
        DeValue::Datetime(date) => NodeKind::Datetime(date.to_string()),
        DeValue::Array(list) => NodeKind::Array(list.iter().map(|v| node(v, unreadable)).collect()),
        DeValue::Table(table) => table_kind(table, unreadable),
    };
    Node { kind, span: value.span() }
}
