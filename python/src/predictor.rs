//! Predicting sample by sample.

use numpy::PyArray1;
use pyo3::prelude::*;

use crate::arrays::vector;
use crate::error::{raised, refused};

/// Torques of a calibrated model, sample by sample, with the memory of its friction.
#[pyclass(module = "aurt")]
pub struct Predictor {
    inner: aurt::Predictor,
}

impl Predictor {
    pub fn of(inner: aurt::Predictor) -> Self {
        Self { inner }
    }
}

#[pymethods]
impl Predictor {
    /// Torques (or currents) of all joints for a sample `dt_s` after the last one; of the first sample it has no effect.
    fn torque<'py>(
        &mut self,
        py: Python<'py>,
        dt_s: f64,
        q: &Bound<'py, PyAny>,
        dq: &Bound<'py, PyAny>,
        ddq: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (q, dq, ddq) = (vector("q", q)?, vector("dq", dq)?, vector("ddq", ddq)?);
        let values = q.iter().chain(&dq).chain(&ddq).chain([&dt_s]);
        if let Some(value) = values.copied().find(|value| !value.is_finite()) {
            return Err(refused(format!("dt_s, q, dq and ddq must be finite numbers; one is {value}")));
        }
        let torque = self.inner.torque(dt_s, &q, &dq, &ddq).map_err(raised)?;
        Ok(PyArray1::from_slice(py, torque))
    }

    /// Forgets the past: the next sample is a first one.
    fn reset(&mut self) {
        self.inner.reset();
    }
}
