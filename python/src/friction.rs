//! Friction models that are Python classes: a batch of samples in, columns out.
//!
//! Every evaluation takes the interpreter's lock, so that these models are slow and calibration with them runs on one core.

use std::sync::Arc;

use aurt::traits::{
    Columns, CoulombModel, HysteresisModel, Invariant, Invariants, JointModel, JointSeries, ModelError,
    Parameter, ViscousBasis,
};
use numpy::{PyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::error::refused;

/// What a model declares, by the names of `aurt.FrictionModel`.
const INVARIANTS: [(&str, Invariant); 9] = [
    ("even_in_load", Invariant::EvenInLoad),
    ("positive", Invariant::Positive),
    ("bounded_by_one", Invariant::BoundedByOne),
    ("odd_in_velocity", Invariant::OddInVelocity),
    ("continuous_in_velocity", Invariant::ContinuousInVelocity),
    ("sign_of_velocity", Invariant::SignOfVelocity),
    ("passive", Invariant::Passive),
    ("rate_independent", Invariant::RateIndependent),
    ("memoryless", Invariant::Memoryless),
];

/// A friction model without memory that a Python object evaluates.
#[derive(Clone)]
struct PythonModel {
    name: String,
    columns: Vec<Parameter>,
    invariants: Invariants,
    reads_load: bool,
    object: Arc<Py<PyAny>>,
}

impl std::fmt::Debug for PythonModel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("PythonModel").field("name", &self.name).finish_non_exhaustive()
    }
}

/// The Coulomb level of a Python object.
pub fn coulomb(given: &Bound<'_, PyAny>) -> PyResult<Box<dyn CoulombModel>> {
    Ok(Box::new(PythonModel::of(given)?))
}

/// The hysteresis of a Python object.
pub fn hysteresis(given: &Bound<'_, PyAny>) -> PyResult<Box<dyn HysteresisModel>> {
    Ok(Box::new(PythonModel::of(given)?))
}

/// The viscous friction of a Python object.
pub fn viscous(given: &Bound<'_, PyAny>) -> PyResult<Box<dyn ViscousBasis>> {
    Ok(Box::new(PythonModel::of(given)?))
}

impl PythonModel {
    fn of(given: &Bound<'_, PyAny>) -> PyResult<Self> {
        let wrong = |what: &str| {
            PyTypeError::new_err(format!(
                "a friction model is a name, a dict, or an object with {what} (aurt.FrictionModel says what it has)"
            ))
        };
        let field = |name: &str| given.getattr(name).map_err(|_| wrong(&format!("`{name}`")));
        if !field("evaluate")?.is_callable() {
            return Err(wrong("a method `evaluate`"));
        }
        let columns: Vec<(String, String)> =
            field("columns")?.extract().map_err(|_| wrong("`columns`, pairs of name and unit"))?;
        if columns.is_empty() {
            return Err(wrong("at least one column"));
        }
        let declared: Vec<String> =
            field("invariants")?.extract().map_err(|_| wrong("`invariants`, a list of words"))?;
        let mut invariants = Vec::new();
        for word in &declared {
            let known = INVARIANTS.iter().find(|(name, _)| name == word);
            invariants.push(known.map(|(_, invariant)| *invariant).ok_or_else(|| {
                let names: Vec<&str> = INVARIANTS.iter().map(|(name, _)| *name).collect();
                refused(format!(
                    "`{word}` is nothing that a model can declare; known are {}",
                    names.join(", ")
                ))
            })?);
        }
        Ok(Self {
            name: field("name")?.extract().map_err(|_| wrong("`name`, a word"))?,
            columns: columns.into_iter().map(|(name, unit)| Parameter::new(name, unit)).collect(),
            invariants: Invariants::of(&invariants),
            reads_load: field("reads_load")?.extract().map_err(|_| wrong("`reads_load`, True or False"))?,
            object: Arc::new(given.clone().unbind()),
        })
    }

    /// Calls the object and copies what it gives.
    fn call(&self, py: Python<'_>, series: &JointSeries<'_>, out: &mut Columns<'_>) -> PyResult<()> {
        let array = |values: &[f64]| PyArray1::from_slice(py, values);
        let given = self.object.bind(py).call_method1(
            "evaluate",
            (
                array(series.time_s),
                array(series.position_rad),
                array(series.velocity_rad_s),
                array(series.acceleration_rad_s2),
                array(series.load_torque),
            ),
        )?;
        let numpy = py.import("numpy")?;
        let array = numpy.call_method1("asarray", (given, numpy.getattr("float64")?))?;
        let (samples, columns) = (series.samples(), self.columns.len());
        let array = match array.getattr("ndim")?.extract::<usize>()? {
            1 if columns == 1 => array.call_method1("reshape", ((-1, 1),))?,
            _ => array,
        };
        let values: PyReadonlyArray2<'_, f64> =
            array.extract().map_err(|_| refused("evaluate() must give an array (samples, columns)"))?;
        if values.shape() != [samples, columns] {
            return Err(refused(format!(
                "evaluate() gave an array of the shape ({}, {}); it must be (samples, columns), here ({samples}, {columns})",
                values.shape()[0],
                values.shape()[1]
            )));
        }
        for (k, column) in values.as_array().columns().into_iter().enumerate() {
            for (row, (to, from)) in out.column_mut(k).iter_mut().zip(column).enumerate() {
                if !from.is_finite() {
                    return Err(refused(format!(
                        "evaluate() gave {from} in column {k}, sample {row} of the batch"
                    )));
                }
                *to = *from;
            }
        }
        Ok(())
    }
}

impl JointModel for PythonModel {
    fn name(&self) -> &str {
        &self.name
    }

    fn columns(&self) -> Vec<Parameter> {
        self.columns.clone()
    }

    fn invariants(&self) -> Invariants {
        self.invariants
    }

    fn reads_load(&self) -> bool {
        self.reads_load
    }

    fn evaluate(
        &self,
        series: &JointSeries<'_>,
        _state: &mut [f64],
        out: &mut Columns<'_>,
    ) -> Result<(), ModelError> {
        Python::attach(|py| {
            self.call(py, series, out).map_err(|error| ModelError::Evaluation {
                model: self.name.clone(),
                reason: error.value(py).to_string(),
            })
        })
    }
}

impl Serialize for PythonModel {
    fn serialize<S: Serializer>(&self, _: S) -> Result<S::Ok, S::Error> {
        Err(serde::ser::Error::custom("it is a Python object, of which a file holds nothing"))
    }
}

impl<'de> Deserialize<'de> for PythonModel {
    fn deserialize<D: Deserializer<'de>>(_: D) -> Result<Self, D::Error> {
        Err(serde::de::Error::custom("a Python object is in no file"))
    }
}

/// The trait of a slot for [`PythonModel`], under a name that no registry lists.
macro_rules! fill_slot {
    ($slot:ident, $name:literal) => {
        #[typetag::serde(name = $name)]
        impl $slot for PythonModel {
            fn boxed_clone(&self) -> Box<dyn $slot> {
                Box::new(self.clone())
            }
        }
    };
}

fill_slot!(CoulombModel, "python object");
fill_slot!(HysteresisModel, "python object");
fill_slot!(ViscousBasis, "python object");
