//! JSON values with a trail of where in the file they stand, so that errors can name the place.

use std::collections::HashMap;
use std::path::Path;

use serde_json::value::RawValue;
use serde_json::{Map, Value};

use super::SCHEMA;
use crate::model::error::Error;
use crate::model::place::{Step, in_words};

/// A value of a model file and the way to it.
#[derive(Debug, Clone)]
pub(super) struct At<'v> {
    pub value: &'v Value,
    steps: Vec<Step>,
}

impl<'v> At<'v> {
    pub(super) const fn root(value: &'v Value) -> Self {
        Self { value, steps: Vec::new() }
    }

    fn step(&self, value: &'v Value, step: Step) -> Self {
        let mut steps = self.steps.clone();
        steps.push(step);
        Self { value, steps }
    }

    pub(super) fn error(&self, reason: impl Into<String>, help: impl Into<Option<String>>) -> Error {
        Error::ModelValue { place: self.steps.clone(), reason: reason.into(), help: help.into() }
    }

    pub(super) fn object(&self) -> Result<&'v Map<String, Value>, Error> {
        self.value.as_object().ok_or_else(|| self.expected("an object"))
    }

    fn expected(&self, what: &str) -> Error {
        let found = match self.value {
            Value::Null => "null",
            Value::Bool(_) => "a boolean",
            Value::Number(_) => "a number",
            Value::String(_) => "a string",
            Value::Array(_) => "a list",
            Value::Object(_) => "an object",
        };
        self.error(format!("expected {what}, found {found}"), None)
    }

    pub(super) fn get(&self, key: &str) -> Result<At<'v>, Error> {
        self.find(key)?.ok_or_else(|| self.error(format!("lacks the key `{key}`"), None))
    }

    pub(super) fn find(&self, key: &str) -> Result<Option<At<'v>>, Error> {
        Ok(self.object()?.get(key).map(|value| self.step(value, Step::Key(key.to_owned()))))
    }

    pub(super) fn items(&self) -> Result<Vec<At<'v>>, Error> {
        let items = self.value.as_array().ok_or_else(|| self.expected("a list"))?;
        Ok(items.iter().enumerate().map(|(i, value)| self.step(value, Step::Item(i))).collect())
    }

    pub(super) fn entries(&self) -> Result<Vec<(&'v str, At<'v>)>, Error> {
        let step =
            |(key, value): (&'v String, &'v Value)| (key.as_str(), self.step(value, Step::Key(key.clone())));
        Ok(self.object()?.iter().map(step).collect())
    }

    pub(super) fn text(&self) -> Result<&'v str, Error> {
        self.value.as_str().ok_or_else(|| self.expected("a string"))
    }

    pub(super) fn number(&self) -> Result<f64, Error> {
        self.value.as_f64().ok_or_else(|| self.expected("a number"))
    }

    pub(super) fn count(&self) -> Result<u64, Error> {
        self.value.as_u64().ok_or_else(|| self.expected("a whole number, zero or above"))
    }

    /// Whether this is a model file of the given kind and of this program's version.
    pub(super) fn check_kind(&self, kind: &str) -> Result<(), Error> {
        let found = self.get("kind")?;
        if found.text()? != kind {
            let reason = format!("is `{}`, but a file of kind `{kind}` is needed", found.text()?);
            return Err(found.error(reason, None));
        }
        let schema = self.get("schema")?;
        if schema.count()? != SCHEMA {
            let reason = format!("is {}, another version of the file", schema.count()?);
            let help = format!(
                "this program reads version {SCHEMA}; make the file anew, or use the program that made it"
            );
            return Err(schema.error(reason, help));
        }
        Ok(())
    }
}

/// Reads a file as JSON.
///
/// # Errors
/// [`Error::Read`] if the file cannot be read, [`Error::ModelFile`] with line and column if it is no JSON.
pub fn read_json(path: &Path) -> Result<(Value, String), Error> {
    let text = aurt_files::read_text(path, aurt_files::MOST_MODEL_BYTES)
        .map_err(|source| Error::Read { path: path.to_owned(), source })?;
    let value = serde_json::from_str(&text).map_err(|e| Error::ModelFile {
        path: path.to_owned(),
        line: e.line(),
        column: e.column(),
        reason: format!("this is not JSON: {e}"),
        help: None,
    })?;
    Ok((value, text))
}

impl Error {
    /// An error about a value inside a model as an error about the file that holds it: with path, line and column.
    ///
    /// `within` leads from the file's outermost value to the model (empty if the file is the model). Other errors
    /// stay as they are.
    #[must_use]
    pub fn in_file(self, path: &Path, text: &str, within: &[&str]) -> Self {
        let Self::ModelValue { place, reason, help } = self else { return self };
        let steps: Vec<Step> = within.iter().map(|key| Step::Key((*key).to_owned())).chain(place).collect();
        let offset = locate(text, &steps);
        let before = text.get(..offset).unwrap_or_default();
        Self::ModelFile {
            path: path.to_owned(),
            line: before.matches('\n').count() + 1,
            column: before.chars().rev().take_while(|c| *c != '\n').count() + 1,
            reason: format!("{}{reason}", in_words(&steps)),
            help,
        }
    }
}

/// The byte offset in `text` of the value that the steps lead to, as far as they lead.
fn locate(text: &str, steps: &[Step]) -> usize {
    let mut rest = text;
    let mut offset = text.len() - text.trim_start().len();
    for step in steps {
        let inner = match step {
            Step::Key(key) => serde_json::from_str::<HashMap<String, &RawValue>>(rest)
                .ok()
                .and_then(|object| object.get(key).map(|raw| raw.get())),
            Step::Item(i) => serde_json::from_str::<Vec<&RawValue>>(rest)
                .ok()
                .and_then(|list| list.get(*i).map(|raw| raw.get())),
        };
        let Some(inner) = inner else { break };
        // `inner` is a part of `text`, so the difference of their addresses is its offset.
        offset = inner.as_ptr() as usize - text.as_ptr() as usize;
        rest = inner;
    }
    offset
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_found_in_its_text() {
        let text = " {\"a\": [1, {\"b\": 2}],\n \"c\\u0064\": 3}";
        let at = |steps: &[Step]| &text[locate(text, steps)..];
        let key = |k: &str| Step::Key(k.to_owned());
        assert!(at(&[]).starts_with("{\"a\""));
        assert!(at(&[key("a"), Step::Item(1), key("b")]).starts_with("2}"));
        assert!(at(&[key("cd")]).starts_with("3}"));
        // A place that does not exist is shown where the way to it ends.
        assert!(at(&[key("a"), Step::Item(7)]).starts_with("[1"));
    }
}
