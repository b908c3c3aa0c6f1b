//! Robots, and the structure of models on top of them.

use std::sync::Arc;

use aurt::Friction;
use aurt::traits::{RegressorTile, RobotModel};
use aurt_experiment::workbench::failure::Failure;
use aurt_plugins::{Registry, SlotModel};
use aurt_rbd::robots::Part;
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::{Map, Value, json};
use std::path::PathBuf;

use crate::arrays::{States, all_finite, vector};
use crate::error::{raised, refused};
use crate::rows::{json_of, rows};
use crate::{friction, pickled};

/// Earth's gravity in a base frame whose z axis points up, m/s².
const GRAVITY_M_S2: [f64; 3] = [0.0, 0.0, -9.81];
/// Samples that are evaluated together.
const AT_ONCE: usize = 256;

/// A robot: its rigid bodies under gravity, without values of their parameters.
#[pyclass(frozen, module = "aurt")]
pub struct Robot {
    pub inner: aurt::Robot,
    /// The robot's name.
    #[pyo3(get)]
    name: String,
}

#[pymethods]
impl Robot {
    /// A part of a URDF file on the link `base` or the root: all joints as a tree, the chain to `tip`, the tree to `tips`, or `joints`.
    #[staticmethod]
    #[pyo3(signature = (path, *, base=None, tip=None, tips=None, joints=None, gravity=GRAVITY_M_S2))]
    fn from_urdf(
        py: Python<'_>,
        path: PathBuf,
        base: Option<String>,
        tip: Option<String>,
        tips: Option<Vec<String>>,
        joints: Option<Vec<String>>,
        gravity: [f64; 3],
    ) -> PyResult<Self> {
        let part = match (tip, tips, joints) {
            (tip, None, None) => Part::from(tip.as_deref()),
            (None, Some(tips), None) => Part::Tips(tips),
            (None, None, Some(joints)) => Part::Joints(joints),
            _ => return Err(refused("`tip`, `tips` and `joints` are three ways to choose a part; give one")),
        };
        let read = || {
            let described = aurt_rbd::robots::read(&path, base.as_deref(), &part, None)?;
            aurt::Robot::of_description(described, gravity)
        };
        Ok(Self::named(py.detach(read).map_err(raised)?, "robot"))
    }

    /// The same of a MuJoCo file, with bodies instead of links.
    #[staticmethod]
    #[pyo3(signature = (path, *, base=None, tip=None, tips=None, joints=None, gravity=GRAVITY_M_S2))]
    fn from_mjcf(
        py: Python<'_>,
        path: PathBuf,
        base: Option<String>,
        tip: Option<String>,
        tips: Option<Vec<String>>,
        joints: Option<Vec<String>>,
        gravity: [f64; 3],
    ) -> PyResult<Self> {
        Self::from_urdf(py, path, base, tip, tips, joints, gravity)
    }

    /// The robot of a table of modified Denavit–Hartenberg parameters: a file, or the text itself with its header.
    #[staticmethod]
    #[pyo3(signature = (table, *, gravity=GRAVITY_M_S2))]
    fn from_mdh(py: Python<'_>, table: PathBuf, gravity: [f64; 3]) -> PyResult<Self> {
        let text = table.to_str().filter(|text| text.contains('\n')).map(str::to_owned);
        let read = || match &text {
            Some(text) => aurt::Robot::from_mdh(text, gravity),
            None => aurt::Robot::read_mdh(&table, gravity),
        };
        Ok(Self::named(py.detach(read).map_err(raised)?, "robot"))
    }

    /// A robot that is known by name: geometry and limits.
    #[staticmethod]
    #[pyo3(signature = (name, *, gravity=GRAVITY_M_S2))]
    fn by_name(py: Python<'_>, name: &str, gravity: [f64; 3]) -> PyResult<Self> {
        let robot = py.detach(|| aurt::Robot::by_name(name, gravity)).map_err(raised)?;
        Ok(Self::named(robot, name))
    }

    /// For `pickle`: the robot's name and state.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String, String))> {
        let restored = py.import("aurt._plain")?.getattr("restored_robot")?;
        Ok((restored, (self.name.clone(), pickled::robot_state(&self.inner).to_string())))
    }

    /// The robot that `__reduce__` took apart.
    #[staticmethod]
    fn _restored(name: String, state: &str) -> PyResult<Self> {
        let state = serde_json::from_str(state).map_err(pickled::broken("robot"))?;
        Ok(Self { inner: pickled::robot(state)?, name })
    }

    /// Number of joints N.
    #[getter]
    fn joints(&self) -> usize {
        self.inner.joints()
    }

    /// Names of the joints, base first.
    #[getter]
    fn joint_names(&self) -> Vec<String> {
        match self.inner.described() {
            Some(described) => described.joint_names.clone(),
            None => (0..self.joints()).map(|joint| format!("joint_{joint}")).collect(),
        }
    }

    /// Limits as rows: joint, lower_rad, upper_rad, velocity_rad_s, torque_nm; nothing of a table.
    #[getter]
    fn limits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let limits = self.inner.described().map(|described| described.limits.as_slice()).unwrap_or_default();
        let row = |(joint, limit): (usize, &aurt_rbd::robots::JointLimits)| {
            json!({
                "joint": joint,
                "lower_rad": limit.position_rad.map(|[low, _]| low),
                "upper_rad": limit.position_rad.map(|[_, high]| high),
                "velocity_rad_s": limit.velocity_rad_s,
                "torque_nm": limit.torque_nm,
            })
        };
        rows(py, &limits.iter().enumerate().map(row).collect::<Vec<_>>())
    }

    /// What a person should know of how the geometry was read.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.inner.notes().to_vec()
    }

    /// The 10 N standard inertial parameters {XX XY XZ YY YZ ZZ mX mY mZ m} of a description that has masses, else None.
    #[getter]
    fn standard_parameters<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        let described = self.inner.described()?;
        Some(PyArray1::from_slice(py, described.standard_parameters.as_ref()?))
    }

    /// The base inertial parameters as rows: name, unit, and the standard parameters that each stands for.
    #[getter]
    fn base_parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let (standard, base) = (self.inner.rigid_body().standard_parameters(), self.inner.base_parameters());
        let row = |(column, combination): (&usize, &Vec<(usize, f64)>)| {
            let of: Map<String, Value> = combination
                .iter()
                .map(|(index, factor)| (standard[*index].name.clone(), json!(factor)))
                .collect();
            json!({
                "name": standard[*column].name, "unit": standard[*column].unit, "index": column, "combination": of,
            })
        };
        rows(py, &base.columns.iter().zip(&base.combinations).map(row).collect::<Vec<_>>())
    }

    /// Values of the base parameters from those of the 10 N standard parameters.
    fn base_values<'py>(
        &self,
        py: Python<'py>,
        parameters: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let standard = self.standard(parameters)?;
        Ok(PyArray1::from_vec(py, self.inner.base_parameters().values(&standard)))
    }

    /// The regressor Y of the base parameters (or of the standard ones), τ = Y π, as an array (samples, joints, parameters).
    #[pyo3(signature = (q, dq, ddq, *, standard=false))]
    fn regressor<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        dq: &Bound<'py, PyAny>,
        ddq: &Bound<'py, PyAny>,
        standard: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (body, joints) = (self.inner.rigid_body(), self.joints());
        let states = States::new(joints, q, dq, ddq, None)?;
        let all = body.standard_parameters().len();
        let columns: Vec<usize> =
            if standard { (0..all).collect() } else { self.inner.base_parameters().columns.clone() };
        let count = columns.len();
        let mut destination = vec![RegressorTile::UNWANTED; joints * all];
        for joint in 0..joints {
            for (k, column) in columns.iter().enumerate() {
                destination[joint * all + column] = (joint * count + k) as u32;
            }
        }
        let mut values = vec![0.0; states.samples() * joints * count];
        let mut tile = vec![0.0; joints * count * AT_ONCE];
        states.for_each(py, AT_ONCE, |motion, first| {
            let samples = motion.samples();
            // Entries that are always zero are never written.
            body.evaluate(
                motion.view(),
                &mut RegressorTile::new(&destination, all, samples, AT_ONCE, &mut tile),
            );
            let rows = &mut values[first * joints * count..(first + samples) * joints * count];
            for (entry, column) in tile.chunks_exact(AT_ONCE).enumerate() {
                let to = rows.iter_mut().skip(entry).step_by(joints * count);
                to.zip(&column[..samples]).for_each(|(to, from)| *to = *from);
            }
            Ok::<(), Failure>(())
        })?;
        let shape = [states.samples(), joints, count];
        let array: Bound<'py, PyArray3<f64>> = PyArray1::from_vec(py, values).reshape(shape)?;
        if states.single() { array.get_item(0) } else { Ok(array.into_any()) }
    }

    /// Rigid-body torques in Nm for every sample, with the 10 N standard parameters of the links (those of the description
    /// unless given).
    #[pyo3(signature = (q, dq, ddq, parameters=None))]
    fn torque<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        dq: &Bound<'py, PyAny>,
        ddq: &Bound<'py, PyAny>,
        parameters: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let described = self.inner.described().and_then(|described| described.standard_parameters.clone());
        let standard = match (parameters, described) {
            (Some(given), _) => self.standard(given)?,
            (None, Some(described)) => described,
            (None, None) => {
                return Err(refused(
                    "the robot's description has no masses; give `parameters`, ten for each link, or calibrate a model",
                ));
            }
        };
        let states = States::new(self.joints(), q, dq, ddq, None)?;
        let body = self.inner.rigid_body();
        let mut tile = vec![0.0; self.joints() * AT_ONCE];
        torques(&states, py, self.joints(), |torque| {
            states.for_each(py, AT_ONCE, |motion, first| {
                body.torque(motion.view(), &standard, &mut tile, AT_ONCE);
                torque.write(first, motion.samples(), &tile, AT_ONCE)
            })
        })
    }

    /// The structure of a model of this robot.
    #[pyo3(signature = (*, coulomb=None, hysteresis=None, viscous=None, arm_terms=None))]
    fn model(
        &self,
        py: Python<'_>,
        coulomb: Option<&Bound<'_, PyAny>>,
        hysteresis: Option<&Bound<'_, PyAny>>,
        viscous: Option<&Bound<'_, PyAny>>,
        arm_terms: Option<Vec<Bound<'_, PyAny>>>,
    ) -> PyResult<Structure> {
        let registry = Registry::linked().map_err(raised)?;
        let named = Named { registry: &registry };
        let friction = Friction::new(
            named.model("coulomb", coulomb, json!({ "model": "constant" }), friction::coulomb)?,
            named.model("hysteresis", hysteresis, json!({ "model": "sign" }), friction::hysteresis)?,
            named.model(
                "viscous",
                viscous,
                json!({ "model": "polynomial", "powers": [1] }),
                friction::viscous,
            )?,
        );
        let mut builder = self.inner.model().friction(friction);
        for term in arm_terms.unwrap_or_default() {
            builder = builder.boxed_arm_term(named.model("arm_terms", Some(&term), Value::Null, |_| {
                Err(PyTypeError::new_err(
                    "an arm term is a name or a dict; models in Python are friction of joints",
                ))
            })?);
        }
        let model = py.detach(|| builder.build()).map_err(raised)?;
        Ok(Structure { model: Arc::new(model) })
    }

    fn __repr__(&self) -> String {
        format!("<aurt.Robot {}: {} joints>", self.name, self.joints())
    }
}

impl Robot {
    fn named(inner: aurt::Robot, otherwise: &str) -> Self {
        let name = inner.described().map_or(otherwise, |described| described.name.as_str()).to_owned();
        Self { inner, name }
    }

    fn standard(&self, given: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
        // Links are more than joints where joints follow others.
        let expected = self.inner.rigid_body().standard_parameters().len();
        let standard = vector("parameters", given)?;
        if standard.len() != expected {
            return Err(refused(format!(
                "parameters has {} values; it must have {expected}, ten for each link: XX XY XZ YY YZ ZZ mX mY mZ m",
                standard.len()
            )));
        }
        match standard.iter().position(|value| !value.is_finite()) {
            Some(k) => Err(refused(format!("value {k} of parameters is {}, no finite number", standard[k]))),
            None => Ok(standard),
        }
    }
}

/// Models as experiments write them: by name, or as a dict with `model` and its keys.
struct Named<'a> {
    registry: &'a Registry,
}

impl Named<'_> {
    /// The model that is given, `default` if none is, and what `own` makes of an object that is neither name nor dict.
    fn model<M: SlotModel + ?Sized>(
        &self,
        what: &str,
        given: Option<&Bound<'_, PyAny>>,
        default: Value,
        own: impl FnOnce(&Bound<'_, PyAny>) -> PyResult<Box<M>>,
    ) -> PyResult<Box<M>> {
        let table = match given {
            None => default,
            Some(given) => match given.extract::<String>() {
                Ok(name) => json!({ "model": name }),
                Err(_) if given.is_instance_of::<PyDict>() => json_of(what, given)?,
                Err(_) => return own(given),
            },
        };
        self.registry.build_from_json(&table).map_err(raised)
    }
}

/// Torques of samples and joints as they come, tile by tile.
pub struct Torque<'a> {
    joints: usize,
    values: &'a mut [f64],
}

/// The array (samples, joints), or (joints,) for a single sample, that `fill` fills. NumPy allocates it: it has larger pages
/// for large arrays.
pub fn torques<'py>(
    states: &States<'_>,
    py: Python<'py>,
    joints: usize,
    fill: impl FnOnce(&mut Torque<'_>) -> PyResult<()>,
) -> PyResult<Bound<'py, PyAny>> {
    let array = PyArray2::<f64>::zeros(py, [states.samples(), joints], false);
    {
        let mut writable = array.try_readwrite()?;
        fill(&mut Torque { joints, values: writable.as_slice_mut()? })?;
    }
    if states.single() { array.get_item(0) } else { Ok(array.into_any()) }
}

impl Torque<'_> {
    /// Writes a tile whose joints are `stride` apart to the samples from `first` on.
    pub fn write(
        &mut self,
        first: usize,
        samples: usize,
        tile: &[f64],
        stride: usize,
    ) -> Result<(), Failure> {
        let joints = self.joints;
        let rows = &mut self.values[first * joints..(first + samples) * joints];
        for joint in 0..joints {
            let column = &tile[joint * stride..joint * stride + samples];
            for (row, value) in rows.chunks_exact_mut(joints).zip(column) {
                row[joint] = *value;
            }
        }
        if all_finite(rows) {
            return Ok(());
        }
        let place = rows.iter().position(|value| !value.is_finite()).unwrap_or(0);
        Err(Failure::Argument {
            option: "torque",
            reason: format!(
                "the torque of joint {} at sample {} is no number",
                place % joints,
                first + place / joints
            ),
            remedy: "the motion or the parameters are far beyond those of a robot".into(),
        })
    }
}

/// The structure of a model: rigid bodies, friction of every joint, arm terms; without values of its coefficients.
#[pyclass(frozen, module = "aurt")]
pub struct Structure {
    pub model: Arc<RobotModel>,
}

impl Structure {
    /// The structure that a user gave, or that of a robot.
    pub fn of(given: &Bound<'_, PyAny>) -> PyResult<Arc<RobotModel>> {
        if let Ok(structure) = given.cast::<Self>() {
            return Ok(structure.get().model.clone());
        }
        if let Ok(robot) = given.cast::<Robot>() {
            return Ok(Arc::new(robot.get().inner.model().build().map_err(raised)?));
        }
        Err(PyTypeError::new_err("the model must be an aurt.Robot, or what its method model() gives"))
    }
}

#[pymethods]
impl Structure {
    /// Number of joints N.
    #[getter]
    fn joints(&self) -> usize {
        self.model.joints()
    }

    /// The coefficients as rows: name and unit.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let row = |p: &aurt::traits::Parameter| json!({"name": p.name, "unit": p.unit});
        rows(py, &self.model.parameters().iter().map(row).collect::<Vec<_>>())
    }

    fn __repr__(&self) -> String {
        let stack = &self.model.stacks()[0];
        let terms: Vec<&str> = self.model.arm_terms().iter().map(|term| term.name()).collect();
        format!(
            "<aurt.Structure: {} joints, {} · {} + {}, arm terms [{}], {} coefficients>",
            self.joints(),
            stack.coulomb().name(),
            stack.hysteresis().name(),
            stack.viscous().name(),
            terms.join(", "),
            self.model.parameters().len()
        )
    }
}
