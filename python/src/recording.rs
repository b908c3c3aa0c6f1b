//! `Recording`: what a robot's joints did and what was measured meanwhile.

use std::path::PathBuf;
use std::sync::Arc;

use aurt::traits::MeasurementUnit;
use aurt_recording::{
    AngleUnit, ColumnRef, ColumnSelection, ColumnsRef, ReadOptions, RecordedAs, TimeUnit, read_recording,
};
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{Matrix, Stamps, samples_by_joint, times, vector};
use crate::error::{raised, refused};
use crate::settings::choice;
use crate::{frames, pickled};

/// Stamps, positions, velocities, measurements, and the rest.
type PickledRecording<'py> = (
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray2<f64>>,
    Option<Bound<'py, PyArray2<f64>>>,
    Option<Bound<'py, PyArray2<f64>>>,
    String,
);

/// What a robot's joints did and what was measured meanwhile.
#[pyclass(frozen, module = "aurt")]
pub struct Recording {
    pub inner: Arc<aurt_recording::Recording>,
}

const UNITS: [(&str, MeasurementUnit); 2] =
    [("Nm", MeasurementUnit::NewtonMetre), ("A", MeasurementUnit::Ampere)];

/// A column: its number from 0, or its name.
#[derive(FromPyObject)]
enum Column {
    Index(usize),
    Name(String),
}

/// The columns of a quantity: `[first, last]` by number, or a number or a name for each joint.
#[derive(FromPyObject)]
enum Columns {
    Range([usize; 2]),
    Numbers(Vec<usize>),
    Names(Vec<String>),
}

impl From<Column> for ColumnRef {
    fn from(column: Column) -> Self {
        match column {
            Column::Index(index) => Self::Index(index),
            Column::Name(name) => Self::Name(name),
        }
    }
}

impl From<Columns> for ColumnsRef {
    fn from(columns: Columns) -> Self {
        match columns {
            Columns::Range([first, last]) => Self::Range { first, last },
            Columns::Numbers(numbers) => Self::List(numbers.into_iter().map(ColumnRef::Index).collect()),
            Columns::Names(names) => Self::List(names.into_iter().map(ColumnRef::Name).collect()),
        }
    }
}

/// Which columns hold what, as `columns` of an experiment.
fn selection(columns: Option<&Bound<'_, PyDict>>) -> PyResult<ColumnSelection> {
    let mut selection = ColumnSelection::default();
    for (key, value) in columns.into_iter().flatten() {
        let key: String = key.extract()?;
        match key.as_str() {
            "time" => selection.time = Some(value.extract::<Column>()?.into()),
            "position" => selection.position = Some(value.extract::<Columns>()?.into()),
            "velocity" => selection.velocity = Some(value.extract::<Columns>()?.into()),
            "measurement" => selection.measurement = Some(value.extract::<Columns>()?.into()),
            _ => {
                return Err(refused(format!(
                    "columns has the key `{key}`; it may have time, position, velocity, measurement"
                )));
            }
        }
    }
    Ok(selection)
}

#[pymethods]
impl Recording {
    /// From arrays (stamps in s, as dates or durations; positions, velocities and measurements with a row for each sample),
    /// from a data frame or an Arrow table whose columns have their usual names, or from a file.
    ///
    /// t : array, or data frame, or path of a file
    ///     Dates count from the first whole second (`origin_s`).
    /// q, dq : array (samples, joints)
    ///     Positions, rad, and velocities, rad/s; not of frames and files.
    /// tau, current : array (samples, joints) or None
    ///     What was measured: joint torques, Nm, or motor currents, A.
    /// unit : {"Nm", "A"} or None
    ///     Unit of the measurement, where a frame or file does not tell.
    /// name : str or None
    ///     What messages and reports call the recording.
    /// joint_names : sequence of str or None
    ///     Those of the robot's joints, base first, as the recording calls them.
    /// topic : str or None
    ///     The topic of a bag that has several of joint states.
    /// columns : dict or None
    ///     Columns of "time", "position", "velocity", "measurement", by number or name, where names do not tell.
    /// angle : {"rad", "deg"} or None
    /// time : {"s", "ms", "us", "ns"} or None
    ///     Units of positions and stamps of a frame or file, where they are unusual.
    #[new]
    #[pyo3(signature = (t, q=None, dq=None, *, tau=None, current=None, unit=None, name=None, joint_names=None, topic=None,
                        columns=None, angle=None, time=None))]
    #[expect(clippy::too_many_arguments, reason = "Python names them")]
    fn new(
        py: Python<'_>,
        t: &Bound<'_, PyAny>,
        q: Option<&Bound<'_, PyAny>>,
        dq: Option<&Bound<'_, PyAny>>,
        tau: Option<&Bound<'_, PyAny>>,
        current: Option<&Bound<'_, PyAny>>,
        unit: Option<&str>,
        name: Option<String>,
        joint_names: Option<Vec<String>>,
        topic: Option<String>,
        columns: Option<&Bound<'_, PyDict>>,
        angle: Option<&str>,
        time: Option<&str>,
    ) -> PyResult<Self> {
        let unit = unit.map(|word| choice("unit", word, &UNITS)).transpose()?;
        let Some(q) = q else {
            if dq.is_some() || tau.is_some() || current.is_some() {
                return Err(PyTypeError::new_err("dq, tau and current need q, the positions"));
            }
            let options = ReadOptions {
                unit,
                needs_measurement: false,
                columns: selection(columns)?,
                recorded: RecordedAs {
                    angle: angle.map(|word| choice("angle", word, &AngleUnit::NAMES)).transpose()?,
                    time: time.map(|word| choice("time", word, &TimeUnit::NAMES)).transpose()?,
                    topic,
                    joint_names,
                    ..RecordedAs::default()
                },
                ..ReadOptions::default()
            };
            let recording = if frames::is_frame(t)? {
                frames::read(t, &options, name.as_deref().unwrap_or("frame"))?
            } else if let Ok(path) = t.extract::<PathBuf>() {
                py.detach(|| read_recording(&path, &options)).map_err(raised)?
            } else {
                return Err(PyTypeError::new_err(
                    "a recording needs t and q, or a data frame, or the path of a file",
                ));
            };
            return Ok(Self::of(match name {
                Some(name) => recording.named(name),
                None => recording,
            }));
        };
        if topic.is_some() || columns.is_some() || angle.is_some() || time.is_some() {
            return Err(PyTypeError::new_err(
                "topic, columns, angle and time are of files and frames; arrays are in s and rad",
            ));
        }
        let q = Matrix::new("q", q, None)?;
        let (joints, Stamps { time_s, origin_s }) = (q.joints(), stamps(t, &q)?);
        let mut recording = aurt_recording::Recording::from_arrays(time_s, q.by_joint()).map_err(raised)?;
        recording.report.origin_s = origin_s;
        if let Some(dq) = dq {
            let dq = Matrix::new("dq", dq, Some(joints))?;
            recording = recording.with_velocity(dq.by_joint()).map_err(raised)?;
        }
        let measured = match (tau, current) {
            (Some(_), Some(_)) => return Err(refused("a recording has tau or current, not both")),
            (Some(tau), None) => Some((Matrix::new("tau", tau, Some(joints))?, MeasurementUnit::NewtonMetre)),
            (None, Some(current)) => {
                Some((Matrix::new("current", current, Some(joints))?, MeasurementUnit::Ampere))
            }
            (None, None) => None,
        };
        if let Some((measured, own)) = measured {
            if unit.is_some_and(|unit| unit != own) {
                return Err(refused(format!("unit contradicts the argument, which is in {}", own.symbol())));
            }
            recording = recording.with_measurement(measured.by_joint(), own).map_err(raised)?;
        }
        if let Some(names) = joint_names {
            recording = recording.with_joint_names(names).map_err(raised)?;
        }
        Ok(Self::of(match name {
            Some(name) => recording.named(name),
            None => recording,
        }))
    }

    /// For `pickle`: the series as arrays, and the rest.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, PickledRecording<'py>)> {
        let inner = &self.inner;
        let optional = |family: &Option<Vec<Vec<f64>>>| {
            family.as_ref().map(|series| samples_by_joint(py, series)).transpose()
        };
        let restored = py.import("aurt._plain")?.getattr("restored_recording")?;
        let state = pickled::recording_state(inner).to_string();
        let (velocity, measured) = (optional(&inner.velocity_rad_s)?, optional(&inner.measurement)?);
        Ok((restored, (self.t(py), self.q(py)?, velocity, measured, state)))
    }

    /// The recording that `__reduce__` took apart.
    #[staticmethod]
    fn _restored(
        t: &Bound<'_, PyAny>,
        q: &Bound<'_, PyAny>,
        dq: Option<&Bound<'_, PyAny>>,
        measured: Option<&Bound<'_, PyAny>>,
        state: &str,
    ) -> PyResult<Self> {
        let series = |name, given: Option<&Bound<'_, PyAny>>| -> PyResult<Option<Vec<Vec<f64>>>> {
            given.map(|given| Ok(Matrix::new(name, given, None)?.by_joint())).transpose()
        };
        let families = [series("q", Some(q))?, series("dq", dq)?, series("measured", measured)?];
        let wrong = pickled::broken("recording");
        let state = serde_json::from_str(state).map_err(&wrong)?;
        let recording = pickled::recording(vector("t", t)?, families, state).map_err(&wrong)?;
        recording.validate().map_err(raised)?;
        Ok(Self::of(recording))
    }

    /// The recording's name, which messages and reports use.
    #[getter]
    fn name(&self) -> String {
        self.inner.file.display().to_string()
    }

    /// Names of the joints, column after column of q; empty where they have none.
    #[getter]
    fn joint_names(&self) -> Vec<String> {
        self.inner.joints.names().to_vec()
    }

    /// Number of joints.
    #[getter]
    fn joints(&self) -> usize {
        self.inner.joints()
    }

    /// Time from the first to the last stamp, s.
    #[getter]
    fn duration_s(&self) -> f64 {
        self.inner.duration_s()
    }

    /// Time stamps, s.
    #[getter]
    fn t<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.inner.time_s)
    }

    /// What t counts from, s from 1970: that of stamps that are dates; 0 of others.
    #[getter]
    fn origin_s(&self) -> f64 {
        self.inner.report.origin_s
    }

    /// Joint angles, rad; (samples, joints).
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        samples_by_joint(py, &self.inner.position_rad)
    }

    /// Measured joint velocities, rad/s, or None.
    #[getter]
    fn dq<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        self.inner.velocity_rad_s.as_ref().map(|series| samples_by_joint(py, series)).transpose()
    }

    /// Measured joint torques, Nm, or None.
    #[getter]
    fn tau<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        self.measured(py, MeasurementUnit::NewtonMetre)
    }

    /// Measured motor currents, A, or None.
    #[getter]
    fn current<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        self.measured(py, MeasurementUnit::Ampere)
    }

    /// Unit of what was measured, "Nm" or "A"; None if nothing was.
    #[getter]
    fn unit(&self) -> Option<&'static str> {
        self.inner.measurement.as_ref().map(|_| self.inner.unit.symbol())
    }

    /// What was found and done while it was read, in sentences.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.inner.report.notes()
    }

    /// The samples between two times, s from the first stamp.
    fn window(&self, from_s: f64, to_s: f64) -> PyResult<Self> {
        Ok(Self::of(self.inner.window([from_s, to_s]).map_err(raised)?))
    }

    /// The same under another name.
    fn named(&self, name: &str) -> Self {
        Self::of(aurt_recording::Recording::clone(&self.inner).named(name))
    }

    fn __len__(&self) -> usize {
        self.inner.samples()
    }

    fn __repr__(&self) -> String {
        let measured =
            self.unit().map_or_else(|| "nothing measured".to_owned(), |unit| format!("measured in {unit}"));
        format!(
            "<aurt.Recording {}: {} samples, {} joints, {:.3} s, {measured}>",
            self.name(),
            self.inner.samples(),
            self.joints(),
            self.duration_s()
        )
    }
}

impl Recording {
    pub fn of(inner: aurt_recording::Recording) -> Self {
        Self { inner: Arc::new(inner) }
    }

    fn measured<'py>(
        &self,
        py: Python<'py>,
        unit: MeasurementUnit,
    ) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let measured = self.inner.measurement.as_ref().filter(|_| self.inner.unit == unit);
        measured.map(|series| samples_by_joint(py, series)).transpose()
    }
}

/// The stamps of positions.
fn stamps(t: &Bound<'_, PyAny>, q: &Matrix<'_>) -> PyResult<Stamps> {
    times(t, q.samples()).map_err(|error| {
        let is_transposed = t.len().is_ok_and(|stamps| stamps == q.joints() && stamps != q.samples());
        if !is_transposed {
            return error;
        }
        refused(format!(
            "q has the shape ({}, {}), and t has {} stamps; a row of q is a sample: transpose it: q.T",
            q.samples(),
            q.joints(),
            q.joints()
        ))
    })
}

/// Recordings that a user gave: one, or a list.
pub fn recordings(
    name: &str,
    given: Option<&Bound<'_, PyAny>>,
) -> PyResult<Vec<Arc<aurt_recording::Recording>>> {
    let Some(given) = given else { return Ok(Vec::new()) };
    if let Ok(one) = given.cast::<Recording>() {
        return Ok(vec![one.get().inner.clone()]);
    }
    let wrong = || PyTypeError::new_err(format!("{name} must be an aurt.Recording or a list of them"));
    let mut list = Vec::new();
    for item in given.try_iter().map_err(|_| wrong())? {
        list.push(item?.cast::<Recording>().map_err(|_| wrong())?.get().inner.clone());
    }
    Ok(list)
}
