//! Arrays of users, checked, as series of joints.

use std::ops::Range;

use aurt::traits::Motion;
use aurt_experiment::workbench::failure::Failure;
use numpy::{
    PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArray,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{raised, refused};

/// Samples after which signals are heard: some milliseconds.
const HEARD_EVERY: usize = 1 << 16;

/// A matrix of samples (rows) and joints (columns), of any layout; nothing is copied that is an array of float64 already.
pub struct Matrix<'py> {
    name: &'static str,
    array: PyReadonlyArray2<'py, f64>,
    /// Whether the user gave a single sample, one number for each joint.
    pub single: bool,
}

/// A NumPy array of float64 of what the user gave: numbers of any type but complex ones, frames, nested lists.
fn float_array<'py>(name: &str, given: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyUntypedArray>> {
    let py = given.py();
    let numpy = py.import("numpy")?;
    let masked = py.import("numpy.ma")?;
    if masked.call_method1("is_masked", (given,))?.is_truthy()? {
        return Err(refused(format!("{name} has masked entries; remove such samples first")));
    }
    let array = numpy.call_method1("asarray", (given,)).map_err(|error| {
        let wrong = PyTypeError::new_err(format!("{name} is no array of numbers"));
        wrong.set_cause(py, Some(error));
        wrong
    })?;
    let dtype = array.getattr("dtype")?;
    let kind: String = dtype.getattr("kind")?.extract()?;
    if !matches!(kind.as_str(), "f" | "i" | "u") {
        let found = dtype.str()?;
        return Err(PyTypeError::new_err(format!(
            "{name} has the dtype {found}; it must be real numbers: convert it with .astype(float)"
        )));
    }
    let options = PyDict::new(py);
    options.set_item("copy", false)?;
    let array = array.call_method("astype", (numpy.getattr("float64")?,), Some(&options))?;
    Ok(array.cast_into::<PyUntypedArray>()?)
}

fn shape_of(shape: &[usize]) -> String {
    let numbers: Vec<String> = shape.iter().map(ToString::to_string).collect();
    let comma = if shape.len() == 1 { "," } else { "" };
    format!("({}{comma})", numbers.join(", "))
}

impl<'py> Matrix<'py> {
    /// The matrix that a user gave for `joints` joints, or, without, for as many as it has columns. One number for each
    /// joint is a single sample.
    pub fn new(name: &'static str, given: &Bound<'py, PyAny>, joints: Option<usize>) -> PyResult<Self> {
        let array = float_array(name, given)?;
        let shape = array.shape().to_vec();
        let (single, array) = match shape[..] {
            [count] if joints == Some(count) => (true, array.call_method1("reshape", ((1, count),))?),
            [_, _] => (false, array.into_any()),
            _ => return Err(refused(wrong_shape(name, &shape, joints))),
        };
        let array: PyReadonlyArray2<'py, f64> = array.extract()?;
        let found = array.shape()[1];
        if joints.is_some_and(|joints| joints != found) || found == 0 {
            return Err(refused(wrong_shape(name, &shape, joints)));
        }
        Ok(Self { name, array, single })
    }

    /// Number of samples.
    pub fn samples(&self) -> usize {
        self.array.shape()[0]
    }

    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.array.shape()[1]
    }

    /// The same as another, which must have as many samples.
    fn check_samples(&self, other: &Self) -> PyResult<()> {
        if self.samples() == other.samples() {
            return Ok(());
        }
        Err(refused(format!(
            "{} has {} samples, {} has {}",
            self.name,
            self.samples(),
            other.name,
            other.samples()
        )))
    }

    /// Calls `work` with the number of samples of every stretch and their values, joint after joint, without the
    /// interpreter's lock; signals are heard between stretches.
    pub fn for_each_stretch(
        &self,
        py: Python<'_>,
        mut work: impl FnMut(usize, &[f64]) -> Result<(), Failure> + Send,
    ) -> PyResult<()> {
        let view = self.view();
        for first in (0..self.samples()).step_by(HEARD_EVERY) {
            let rows = first..(first + HEARD_EVERY).min(self.samples());
            py.check_signals()?;
            py.detach(|| work(rows.len(), &view.joint_after_joint(&rows)?)).map_err(raised)?;
        }
        Ok(())
    }

    /// The series of all joints, `[joint][sample]`.
    pub fn by_joint(&self) -> Vec<Vec<f64>> {
        self.array.as_array().columns().into_iter().map(|column| column.to_vec()).collect()
    }

    /// A view for work without the interpreter's lock.
    pub fn view(&self) -> View<'_> {
        View { name: self.name, values: self.array.as_array() }
    }
}

/// Whether all values are finite; without an early end, so that it is a few instructions for many values.
pub fn all_finite(values: &[f64]) -> bool {
    values.iter().fold(true, |all, value| all & value.is_finite())
}

/// A [`Matrix`] that needs no lock.
#[derive(Clone, Copy)]
pub struct View<'a> {
    name: &'static str,
    values: numpy::ndarray::ArrayView2<'a, f64>,
}

impl View<'_> {
    /// The samples `rows`, joint after joint.
    ///
    /// # Errors
    /// The first value that is not finite.
    fn joint_after_joint(&self, rows: &Range<usize>) -> Result<Vec<f64>, Failure> {
        let (joints, count) = (self.values.ncols(), rows.len());
        let mut series = Vec::with_capacity(joints * count);
        match self.values.to_slice() {
            // Rows one after another, as most arrays have them.
            Some(all) => {
                let all = &all[rows.start * joints..rows.end * joints];
                (0..joints).for_each(|joint| series.extend(all.chunks_exact(joints).map(|row| row[joint])));
            }
            None => (0..joints).for_each(|joint| {
                let from = self.values.column(joint);
                series.extend(rows.clone().map(|k| from[k]));
            }),
        }
        if all_finite(&series) {
            return Ok(series);
        }
        match series.iter().position(|value| !value.is_finite()) {
            None => Ok(series),
            Some(place) => {
                let (joint, row) = (place / rows.len(), rows.start + place % rows.len());
                Err(Failure::Argument {
                    option: self.name,
                    reason: format!("sample {row} of joint {joint} is {}, no finite number", series[place]),
                    remedy: "remove such samples first".into(),
                })
            }
        }
    }
}

fn wrong_shape(name: &str, shape: &[usize], joints: Option<usize>) -> String {
    let expected = joints.map_or_else(|| "joints".to_owned(), |joints| joints.to_string());
    let transposed = shape.len() == 2 && joints == Some(shape[0]);
    let hint = if transposed { format!("; transpose it: {name}.T") } else { String::new() };
    format!(
        "{name} has the shape {}; it must be (samples, {expected}), a row for each sample{hint}",
        shape_of(shape)
    )
}

/// Positions, velocities and accelerations of a motion, and the times if they are known.
pub struct States<'py> {
    q: Matrix<'py>,
    dq: Matrix<'py>,
    ddq: Matrix<'py>,
    time_s: Option<Vec<f64>>,
}

impl<'py> States<'py> {
    /// The states of `joints` joints that a user gave.
    pub fn new(
        joints: usize,
        q: &Bound<'py, PyAny>,
        dq: &Bound<'py, PyAny>,
        ddq: &Bound<'py, PyAny>,
        t: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Self> {
        let [q, dq, ddq] =
            [("q", q), ("dq", dq), ("ddq", ddq)].map(|(name, given)| Matrix::new(name, given, Some(joints)));
        let (q, dq, ddq) = (q?, dq?, ddq?);
        q.check_samples(&dq)?;
        q.check_samples(&ddq)?;
        let time_s = t.map(|t| times(t, q.samples())).transpose()?.map(|stamps| stamps.time_s);
        Ok(Self { q, dq, ddq, time_s })
    }

    /// Whether times are known.
    pub fn has_times(&self) -> bool {
        self.time_s.is_some()
    }

    /// Number of samples.
    pub fn samples(&self) -> usize {
        self.q.samples()
    }

    /// Whether the user gave a single sample, one number for each joint.
    pub fn single(&self) -> bool {
        self.q.single
    }

    /// Calls `work` with every stretch of `at_once` samples and its first sample, without the interpreter's lock; signals
    /// are heard every so often.
    pub fn for_each<E: Into<Failure> + Send>(
        &self,
        py: Python<'_>,
        at_once: usize,
        mut work: impl FnMut(Motion, usize) -> Result<(), E> + Send,
    ) -> PyResult<()> {
        let joints = self.q.joints();
        let views = [self.q.view(), self.dq.view(), self.ddq.view()];
        let time_s = self.time_s.as_deref();
        for first in (0..self.samples()).step_by(HEARD_EVERY) {
            let end = (first + HEARD_EVERY).min(self.samples());
            py.check_signals()?;
            py.detach(|| -> Result<(), Failure> {
                for start in (first..end).step_by(at_once) {
                    let rows = start..(start + at_once).min(end);
                    let times = time_s.map_or_else(|| vec![0.0; rows.len()], |t| t[rows.clone()].to_vec());
                    let [q, dq, ddq] = views.map(|view| view.joint_after_joint(&rows));
                    let motion = Motion::new(joints, times, q?, dq?, ddq?)?;
                    work(motion, start).map_err(Into::into)?;
                }
                Ok(())
            })
            .map_err(raised)?;
        }
        Ok(())
    }
}

/// Time stamps for `samples` samples, s: numbers, durations, or dates, which count from the first whole second.
pub fn times(given: &Bound<'_, PyAny>, samples: usize) -> PyResult<Stamps> {
    let moments = given.py().import("aurt._plain")?.call_method1("seconds", (given,))?;
    let (stamps, origin_s) = if moments.is_none() {
        (vector("t", given)?, 0.0)
    } else {
        let (seconds, origin_s): (Bound<'_, PyAny>, f64) = moments.extract()?;
        (vector("t", &seconds)?, origin_s)
    };
    if stamps.len() != samples {
        return Err(refused(format!("t has {} stamps for {samples} samples", stamps.len())));
    }
    if let Some(k) = stamps.iter().position(|stamp| !stamp.is_finite()) {
        return Err(refused(format!("stamp {k} of t is {}, no finite number", stamps[k])));
    }
    if let Some(k) = stamps.windows(2).position(|pair| pair[1] < pair[0]) {
        return Err(refused(format!(
            "stamp {} of t lies before the one before it; sort the samples by time",
            k + 1
        )));
    }
    Ok(Stamps { time_s: stamps, origin_s })
}

/// Time stamps, s from `origin_s`, which is 0 or, of dates, s from 1970.
pub struct Stamps {
    pub time_s: Vec<f64>,
    pub origin_s: f64,
}

/// A list of numbers.
pub fn vector(name: &str, given: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let array = float_array(name, given)?;
    let shape = array.shape().to_vec();
    if shape.len() != 1 {
        return Err(refused(format!(
            "{name} has the shape {}; it must be a list of numbers",
            shape_of(&shape)
        )));
    }
    let array: PyReadonlyArray1<'_, f64> = array.extract()?;
    Ok(array.as_array().to_vec())
}

/// An array of samples (rows) from series of joints.
pub fn samples_by_joint<'py>(py: Python<'py>, by_joint: &[Vec<f64>]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (joints, samples) = (by_joint.len(), by_joint.first().map_or(0, Vec::len));
    let mut rows = vec![0.0; joints * samples];
    for (joint, series) in by_joint.iter().enumerate() {
        rows.iter_mut().skip(joint).step_by(joints).zip(series).for_each(|(to, from)| *to = *from);
    }
    shaped(py, rows, [samples, joints])
}

/// An array of rows that stand one after another.
pub fn shaped<'py>(
    py: Python<'py>,
    rows: Vec<f64>,
    shape: [usize; 2],
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    PyArray1::from_vec(py, rows).reshape(shape)
}
