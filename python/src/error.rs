//! Errors of the library as Python exceptions.

use aurt_experiment::workbench::failure::Failure;
use pyo3::exceptions::PyValueError;
use pyo3::{PyErr, create_exception};

create_exception!(
    _aurt,
    Error,
    PyValueError,
    "What is wrong with a robot, a recording, a model or an argument, where, and what to do."
);

/// The exception of a failure, in the words of the command line.
pub fn raised(failure: impl Into<Failure>) -> PyErr {
    Error::new_err(failure.into().to_string())
}

/// The exception of an argument.
pub fn refused(message: impl Into<String>) -> PyErr {
    Error::new_err(message.into())
}
