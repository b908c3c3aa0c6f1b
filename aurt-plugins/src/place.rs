//! Deserialising a model from a [`Node`] so that serde's errors know where they happened.
//!
//! `typetag` hands errors on as plain text, so their place is kept beside them: the deserialiser notes each key
//! and value that it is about to read, and after a failure the note names the culprit. This works as long as the
//! `model` key comes first, for then `typetag` reads on without buffering.

use std::cell::RefCell;

use serde::de::value::Error;
use serde::de::{self, DeserializeSeed, IntoDeserializer, MapAccess, SeqAccess, Visitor};
use serde::{Deserializer, forward_to_deserialize_any};

use crate::configuration::{Entry, Node, NodeKind, Span};

#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Place {
    /// Where it stands.
    pub span: Span,
    /// The model's key that it belongs to; none for the model as a whole.
    pub key: Option<String>,
}

/// A deserialiser over a model's table that notes where it is.
#[derive(Debug, Clone, Copy)]
pub struct Tracked<'n> {
    node: &'n Node,
    place: &'n RefCell<Place>,
    depth: usize,
}

impl<'n> Tracked<'n> {
    pub(crate) const fn new(node: &'n Node, place: &'n RefCell<Place>) -> Self {
        Self { node, place, depth: 0 }
    }
}

impl<'de> Deserializer<'de> for Tracked<'de> {
    type Error = Error;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match &self.node.kind {
            NodeKind::Null => visitor.visit_unit(),
            NodeKind::Boolean(b) => visitor.visit_bool(*b),
            NodeKind::Integer(n) => visitor.visit_i64(*n),
            NodeKind::Float(x) => visitor.visit_f64(*x),
            NodeKind::String(text) | NodeKind::Datetime(text) => visitor.visit_borrowed_str(text),
            NodeKind::Array(list) => visitor.visit_seq(Items { rest: list.iter(), parent: self }),
            NodeKind::Table(entries) => visitor.visit_map(Entries {
                // `typetag` streams only what follows the tag.
                ordered: entries
                    .iter()
                    .filter(|e| self.depth == 0 && e.key == "model")
                    .chain(entries.iter().filter(|e| self.depth > 0 || e.key != "model"))
                    .collect::<Vec<_>>()
                    .into_iter(),
                value: None,
                parent: self,
            }),
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        if self.node.kind == NodeKind::Null { visitor.visit_none() } else { visitor.visit_some(self) }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        visitor: V,
    ) -> Result<V::Value, Error> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        match &self.node.kind {
            NodeKind::String(text) => visitor.visit_enum(text.as_str().into_deserializer()),
            NodeKind::Table(entries) => visitor.visit_enum(de::value::MapAccessDeserializer::new(Entries {
                ordered: entries.iter().collect::<Vec<_>>().into_iter(),
                value: None,
                parent: self,
            })),
            _ => Err(de::Error::custom(format!("expected a name, found {}", self.node.kind_name()))),
        }
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf unit
        unit_struct seq tuple tuple_struct map struct identifier ignored_any
    }
}

struct Items<'n> {
    rest: std::slice::Iter<'n, Node>,
    parent: Tracked<'n>,
}

impl<'de> SeqAccess<'de> for Items<'de> {
    type Error = Error;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, Error> {
        let Some(node) = self.rest.next() else {
            self.parent.place.borrow_mut().span = self.parent.node.span.clone();
            return Ok(None);
        };
        self.parent.place.borrow_mut().span = node.span.clone();
        seed.deserialize(Tracked { node, depth: self.parent.depth + 1, ..self.parent }).map(Some)
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.rest.len())
    }
}

struct Entries<'n> {
    ordered: std::vec::IntoIter<&'n Entry>,
    value: Option<&'n Entry>,
    parent: Tracked<'n>,
}

impl<'de> MapAccess<'de> for Entries<'de> {
    type Error = Error;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, Error> {
        let mut place = self.parent.place.borrow_mut();
        let Some(entry) = self.ordered.next() else {
            // What is still wrong when all keys are read (a missing one) concerns the table as a whole.
            place.span = self.parent.node.span.clone();
            if self.parent.depth == 0 {
                *place = whole(self.parent.node);
            }
            return Ok(None);
        };
        place.span = entry.key_span.clone();
        if self.parent.depth == 0 {
            place.key = Some(entry.key.clone());
        }
        drop(place);
        self.value = Some(entry);
        seed.deserialize(entry.key.as_str().into_deserializer()).map(Some)
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, Error> {
        let Some(entry) = self.value.take() else {
            return Err(de::Error::custom("a value was asked for before its key"));
        };
        self.parent.place.borrow_mut().span = entry.value.span.clone();
        seed.deserialize(Tracked { node: &entry.value, depth: self.parent.depth + 1, ..self.parent })
    }
}

/// The place of complaints about a model's table as a whole: its name.
pub(crate) fn whole(table: &Node) -> Place {
    let span = table.get("model").map_or_else(|| table.span.clone(), |name| name.span.clone());
    Place { span, key: None }
}

/// The place of a complaint about one key of a model's table.
pub(crate) fn of_key(table: &Node, key: &str) -> Place {
    table
        .get(key)
        .map_or_else(|| whole(table), |value| Place { span: value.span.clone(), key: Some(key.to_owned()) })
}

/// The place of a complaint about a key of a model's table itself, not its value.
pub(crate) fn of_name(table: &Node, key: &str) -> Place {
    table.entry(key).map_or_else(
        || whole(table),
        |entry| Place { span: entry.key_span.clone(), key: Some(key.to_owned()) },
    )
}

/// The place of a complaint in words, from the first of the table's keys that it names in backticks.
pub(crate) fn of_message(table: &Node, message: &str) -> Place {
    let key =
        message.split('`').skip(1).step_by(2).find(|word| *word != "model" && table.entry(word).is_some());
    match key {
        Some(key) if message.starts_with("unknown key") => of_name(table, key),
        Some(key) => of_key(table, key),
        None => whole(table),
    }
}
