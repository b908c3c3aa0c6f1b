//! Between JSON and Python: rows as data frames, dicts as tables.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use serde_json::Value;

/// A JSON document as Python's dicts, lists and numbers.
pub fn python_of<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (value.to_string(),))
}

/// Python's dicts, lists and numbers as JSON.
///
/// # Errors
/// What has no place in it.
pub fn json_of(name: &str, given: &Bound<'_, PyAny>) -> PyResult<Value> {
    let py = given.py();
    let options = pyo3::types::PyDict::new(py);
    options.set_item("allow_nan", false)?;
    let plain = py.import("aurt._plain")?.getattr("plain")?;
    options.set_item("default", plain)?;
    let text = py.import("json")?.call_method("dumps", (given,), Some(&options)).map_err(|error| {
        let wrong = PyTypeError::new_err(format!(
            "{name} holds what is neither text nor a finite number, list or dict"
        ));
        wrong.set_cause(py, Some(error));
        wrong
    })?;
    serde_json::from_str(&text.extract::<String>()?)
        .map_err(|error| PyTypeError::new_err(format!("{name}: {error}")))
}

/// Rows as a data frame where pandas is there, else as a list of dicts.
pub fn rows<'py>(py: Python<'py>, rows: &[Value]) -> PyResult<Bound<'py, PyAny>> {
    let list = python_of(py, &Value::Array(rows.to_vec()))?;
    py.import("aurt._plain")?.call_method1("rows", (list,))
}
