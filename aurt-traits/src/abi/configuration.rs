//! Reading a model's configuration so that a complaint can name the key.

use std::cell::RefCell;

use serde::de::{DeserializeOwned, DeserializeSeed, IntoDeserializer, MapAccess, Visitor};
use serde::{Deserializer, forward_to_deserialize_any};
use serde_json::{Error, Map, Value};

/// The keys of a model, its name first, as `typetag` wants it.
pub(super) struct Keyed {
    entries: Vec<(String, Value)>,
}

impl Keyed {
    pub(super) fn new(name: &str, keys: Map<String, Value>) -> Self {
        let tag = ("model".to_owned(), Value::from(name));
        Self { entries: std::iter::once(tag).chain(keys).collect() }
    }

    /// Reads the model; a complaint begins with the key that was being read.
    pub(super) fn read<M: DeserializeOwned>(self) -> Result<M, String> {
        let key = RefCell::new(None);
        M::deserialize(Entries { rest: self.entries.into_iter(), value: None, key: &key }).map_err(|e| {
            let key = key.take().filter(|key| !e.to_string().contains(&format!("`{key}`")));
            key.map_or_else(|| e.to_string(), |key| format!("`{key}`: {e}"))
        })
    }
}

/// A deserialiser over the entries that notes the key it is at.
struct Entries<'k> {
    rest: std::vec::IntoIter<(String, Value)>,
    value: Option<Value>,
    key: &'k RefCell<Option<String>>,
}

impl<'de> Deserializer<'de> for Entries<'_> {
    type Error = Error;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        visitor.visit_map(self)
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option unit
        unit_struct newtype_struct seq tuple tuple_struct map struct enum identifier ignored_any
    }
}

impl<'de> MapAccess<'de> for Entries<'_> {
    type Error = Error;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, Error> {
        let Some((key, value)) = self.rest.next() else {
            *self.key.borrow_mut() = None;
            return Ok(None);
        };
        self.value = Some(value);
        *self.key.borrow_mut() = Some(key.clone());
        seed.deserialize(IntoDeserializer::<Error>::into_deserializer(key)).map(Some)
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, Error> {
        seed.deserialize(self.value.take().unwrap_or_default())
    }
}
