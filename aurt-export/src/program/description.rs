//! Models as model files describe them.

use serde_json::Value as Json;

use crate::ExportError;

pub(crate) fn number(description: &Json, key: &str, place: &str) -> Result<f64, ExportError> {
    description.get(key).and_then(Json::as_f64).ok_or_else(|| ExportError::Model {
        place: place.to_owned(),
        model: description.get("model").and_then(Json::as_str).unwrap_or("?").to_owned(),
        reason: "its description lacks a parameter, so it was made by another version",
        known: "the models of this version".into(),
    })
}

/// A model's description, as model files have it.
pub(crate) fn described(
    description: Result<Json, serde_json::Error>,
    place: String,
) -> Result<Json, ExportError> {
    description.map_err(|source| ExportError::Description { place, source })
}

pub(crate) fn unknown(place: String, name: &str, state: usize, known: &str) -> ExportError {
    let reason = if state > 0 {
        "it has memory of its own kind, which this export does not know"
    } else {
        "its equation is not known to this export (a plugin, or a model that is not written as a source yet)"
    };
    ExportError::Model { place, model: name.to_owned(), reason, known: known.to_owned() }
}
