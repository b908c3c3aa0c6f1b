//! Calibration, and the models that it gives.

use std::path::PathBuf;
use std::sync::Arc;

use aurt::traits::{ArmTerm, Invariant, RobotModel};
use aurt::{CalibratedModel, Calibrator, EquationOfMotion, Outcome, Settings, TorqueSeries};
use aurt_experiment::Experiment;
use aurt_experiment::workbench::experiments::fit_experiment;
use aurt_experiment::workbench::exporting::Replaced;
use aurt_plugins::Registry;
use aurt_report::reports::calibration;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde_json::json;

use crate::arrays::{Matrix, States, all_finite, samples_by_joint, shaped};
use crate::error::{raised, refused};
use crate::export::{Exported, Order};
use crate::predictor::Predictor;
use crate::recording::{Recording, recordings};
use crate::report::Report;
use crate::robot::{Structure, torques};
use crate::rows::rows;
use crate::settings::{listener, with_settings};
use crate::work;

/// Samples that are evaluated together.
const AT_ONCE: usize = 256;

/// A model with its coefficients.
#[pyclass(frozen, module = "aurt")]
pub struct Model {
    pub calibrated: Arc<CalibratedModel>,
    /// What calibration found, unless the model is from a file.
    outcome: Option<Outcome>,
}

with_settings! {
    /// Calibrates a model on recordings, and judges it on them and on those that are held out.
    ///
    /// model : Robot or Structure
    /// calibration : Recording or sequence of Recording
    ///     What the coefficients are fitted to.
    /// validation : Recording or sequence of Recording or None
    ///     What is held out, to judge the model.
    calibrate(validation) -> Model = calibrated
}

fn calibrated(
    py: Python<'_>,
    model: &Bound<'_, PyAny>,
    calibration: &Bound<'_, PyAny>,
    validation: Option<&Bound<'_, PyAny>>,
    settings: Settings,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Model> {
    let structure = Structure::of(model)?;
    let fitted = recordings("calibration", Some(calibration))?;
    let held_out = recordings("validation", validation)?;
    if fitted.is_empty() {
        return Err(refused("calibration lists no recording"));
    }
    let progress = listener(progress)?;
    let outcome = work::run(py, progress.as_ref(), move |progress| {
        let mut calibrator = Calibrator::new(RobotModel::clone(&structure)).settings(settings);
        for recording in &fitted {
            calibrator = calibrator.calibration(recording);
        }
        for recording in &held_out {
            calibrator = calibrator.validation(recording);
        }
        Ok(calibrator.calibrate_with_series(progress)?)
    })?;
    Ok(Model::of(outcome))
}

/// Calibrates as an experiment's file says.
#[pyfunction]
#[pyo3(signature = (path, *, progress=None))]
pub fn calibrate_experiment(
    py: Python<'_>,
    path: PathBuf,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Model> {
    let progress = listener(progress)?;
    let outcome = work::run(py, progress.as_ref(), move |progress| {
        let experiment = Experiment::read(path, &mut Registry::of_user()?)?;
        fit_experiment(&experiment, progress)
    })?;
    Ok(Model::of(outcome))
}

impl Model {
    fn of(outcome: Outcome) -> Self {
        Self { calibrated: Arc::new(outcome.calibrated.clone()), outcome: Some(outcome) }
    }

    /// A model without the recordings that it was judged on.
    pub fn alone(calibrated: CalibratedModel) -> Self {
        Self { calibrated: Arc::new(calibrated), outcome: None }
    }
}

#[pymethods]
impl Model {
    /// Reads a model that `save` or the command line wrote.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        Ok(Self::alone(py.detach(|| CalibratedModel::load(&path)).map_err(raised)?))
    }

    /// Writes the model into a file, which appears whole or not at all.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| self.calibrated.save(&path)).map_err(raised)
    }

    /// For `pickle`: the contents of the model's file.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        let contents = py.detach(|| self.calibrated.to_file()).map_err(raised)?;
        Ok((py.import("aurt._plain")?.getattr("unpickled")?, (PyBytes::new(py, &contents),)))
    }

    /// Number of joints N.
    #[getter]
    fn joints(&self) -> usize {
        self.calibrated.model.joints()
    }

    /// Unit of predictions, "Nm" or "A".
    #[getter]
    fn unit(&self) -> &'static str {
        self.calibrated.calibration.unit.symbol()
    }

    /// Torques (or currents) for every sample of a motion; friction with memory starts at the first and needs the times.
    #[pyo3(signature = (q, dq, ddq, t=None))]
    fn torque<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        dq: &Bound<'py, PyAny>,
        ddq: &Bound<'py, PyAny>,
        t: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let states = States::new(self.joints(), q, dq, ddq, t)?;
        if let Some(name) = self.memory()
            && !states.has_times()
            && !states.single()
        {
            return Err(refused(format!(
                "the model `{name}` remembers the motion and needs the time stamps: give t, one for each sample"
            )));
        }
        let mut series = TorqueSeries::new(&self.calibrated).map_err(raised)?;
        torques(&states, py, self.joints(), |torque| {
            states.for_each(py, AT_ONCE, |motion, first| {
                let (values, stride) = series.next(motion.view())?;
                torque.write(first, motion.samples(), values, stride)
            })
        })
    }

    /// The mass matrices M(q) at positions q, (samples, joints, joints): bodies, rotors, payload, coupled motors; in the unit of
    /// predictions per rad/s² (kg m² for Nm). A single position gives one matrix.
    fn mass_matrix<'py>(&self, py: Python<'py>, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let joints = self.joints();
        let mut equation = EquationOfMotion::new(&self.calibrated).map_err(raised)?;
        let (q, mut mass) = (Matrix::new("q", q, Some(joints))?, Vec::new());
        q.for_each_stretch(py, |positions, angles| {
            mass.extend(equation.mass_matrices(positions, angles)?);
            Ok(())
        })?;
        let array =
            PyArray1::from_vec(py, finite("mass matrix", mass)?).reshape([q.samples(), joints, joints])?;
        if q.single { array.get_item(0) } else { Ok(array.into_any()) }
    }

    /// The torques of weight g(q) at positions q, (samples, joints), in the unit of predictions: bodies, payload, a tilted base;
    /// neither friction nor springs.
    fn gravity<'py>(&self, py: Python<'py>, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let joints = self.joints();
        let mut equation = EquationOfMotion::new(&self.calibrated).map_err(raised)?;
        let (q, mut gravity) = (Matrix::new("q", q, Some(joints))?, Vec::new());
        q.for_each_stretch(py, |positions, angles| {
            gravity.extend(equation.gravity(positions, angles)?);
            Ok(())
        })?;
        let array = shaped(py, finite("gravity", gravity)?, [q.samples(), joints])?;
        if q.single { array.get_item(0) } else { Ok(array.into_any()) }
    }

    /// What the model predicts at every stamp of a recording, preprocessed as the model's own were; (samples, joints).
    fn predict<'py>(&self, py: Python<'py>, recording: &Recording) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (model, recording) = (self.calibrated.clone(), recording.inner.clone());
        let predicted = work::run(py, None, move |_| Ok(model.predict_at_stamps(&recording)?))?;
        if predicted.iter().flatten().any(|value| !value.is_finite()) {
            return Err(refused(
                "the prediction holds what is no number; the motion is far beyond that of a robot",
            ));
        }
        samples_by_joint(py, &predicted)
    }

    /// A predictor for single samples, in a control loop.
    fn predictor(&self) -> PyResult<Predictor> {
        Ok(Predictor::of(self.calibrated.predictor().map_err(raised)?))
    }

    /// Writes the model for another program into the folder `out`, as `aurt export` does, and says what was lost.
    ///
    /// target : {"c", "rust", "mjcf", "urdf", "sdf", "fmu"}
    /// out : path
    ///     The folder; made if it does not exist.
    /// name : str, default "robot"
    ///     What files and functions are called after.
    /// kind : {"inverse", "forward"} or None
    ///     What an FMU computes; of the target "fmu" alone, which needs it.
    /// into : path or None
    ///     A MuJoCo or URDF file of yours, which is written with corrected dynamics instead of a new one.
    /// base, tip : str or None
    ///     Bodies of that file between which the chain is, where there is a choice.
    /// force : bool, default False
    ///     Whether files in the folder are replaced that no export wrote, and FMUs.
    #[pyo3(signature = (target, out, *, name="robot", kind=None, into=None, base=None, tip=None, force=false))]
    fn export(
        &self,
        py: Python<'_>,
        target: &str,
        out: PathBuf,
        name: &str,
        kind: Option<&str>,
        into: Option<PathBuf>,
        base: Option<String>,
        tip: Option<String>,
        force: bool,
    ) -> PyResult<Exported> {
        let order = Order::new(target, kind, into, [base, tip], name)?;
        let model = self.calibrated.clone();
        let replaced = if force { Replaced::Any } else { Replaced::Exports };
        work::run(py, None, move |_| order.carry_out(&model, &out, replaced))
    }

    /// How the model moves when it follows the recording's motion, or when what was measured drives it.
    #[pyo3(signature = (recording, *, driven_by="motion", bandwidth_hz=10.0))]
    fn simulate(
        &self,
        py: Python<'_>,
        recording: &Recording,
        driven_by: &str,
        bandwidth_hz: f64,
    ) -> PyResult<Recording> {
        let drive = match driven_by {
            "motion" if bandwidth_hz.is_finite() && bandwidth_hz > 0.0 => {
                aurt::Drive::Motion { bandwidth_hz }
            }
            "motion" => {
                return Err(refused(format!("bandwidth_hz is {bandwidth_hz}; it must be a positive number")));
            }
            "measurement" => aurt::Drive::Measurement,
            other => {
                return Err(refused(format!(
                    "driven_by is `{other}`; it must be \"motion\" or \"measurement\""
                )));
            }
        };
        let (model, recording) = (self.calibrated.clone(), recording.inner.clone());
        Ok(Recording::of(work::run(py, None, move |progress| Ok(model.moved(&recording, drive, progress)?))?))
    }

    /// The coefficients as rows: name, unit, value, std_dev, relative_std_dev_percent, interval_95, excited.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let list: Vec<_> = self.calibrated.calibration.parameters.iter().map(|p| json!(p)).collect();
        rows(py, &list)
    }

    /// The coefficients.
    #[getter]
    fn coefficients<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.calibrated.calibration.coefficients())
    }

    /// The covariance of the coefficients, (n, n), in the order of `parameters`: entry (k, l) is in unit k times unit l of
    /// `parameters`, the root of entry (k, k) is its `std_dev`. NaN where a coefficient is not excited. With
    /// estimator="consistent" it is that of the least squares before.
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let calibration = &self.calibrated.calibration;
        let (n, matrix) = (calibration.parameters.len(), calibration.covariance_matrix());
        let matrix = matrix.ok_or_else(|| {
            refused("the covariance of this model is not known, or not finite: its file has none; calibrate again")
        })?;
        shaped(py, matrix, [n, n])
    }

    /// The errors as rows, one for each recording and joint; all rows, and those in which the joint moves.
    #[getter]
    fn errors<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let mut list = Vec::new();
        for result in self.outcome.iter().flat_map(|outcome| &outcome.recordings) {
            let (all, moving) = (&result.validation.all, &result.validation.moving);
            for joint in 0..self.joints() {
                list.push(json!({
                    "recording": result.label,
                    "role": result.role.name(),
                    "joint": joint,
                    "samples": all.samples[joint],
                    "mse": all.mse[joint],
                    "nmse": all.nmse[joint],
                    "nrmse": all.nrmse[joint],
                    "moving_samples": moving.samples[joint],
                    "moving_mse": moving.mse[joint],
                    "moving_nmse": moving.nmse[joint],
                    "moving_nrmse": moving.nrmse[joint],
                }));
            }
        }
        rows(py, &list)
    }

    /// σ_j, what the model leaves of each joint in the fit, in the unit of predictions.
    #[getter]
    fn sigma<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.calibrated.calibration.sigma)
    }

    /// What a user should know of this calibration.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.calibrated.calibration.warnings.clone()
    }

    /// The structure, without coefficients.
    #[getter]
    fn structure(&self) -> Structure {
        Structure { model: Arc::new(self.calibrated.model.clone()) }
    }

    /// The report of the calibration.
    fn report(&self) -> PyResult<Report> {
        let outcome = self.outcome.as_ref().ok_or_else(|| {
            refused("this model has no recordings to report on; those that calibrate() gives have")
        })?;
        Ok(Report::of(&calibration::of_outcome(outcome)))
    }

    fn __repr__(&self) -> String {
        let calibration = &self.calibrated.calibration;
        format!(
            "<aurt.Model: {} joints, {} coefficients, calibrated on {}, in {}>",
            self.joints(),
            calibration.parameters.len(),
            calibration.recordings.join(", "),
            self.unit()
        )
    }
}

/// The values, if all of them are numbers.
fn finite(what: &str, values: Vec<f64>) -> PyResult<Vec<f64>> {
    if all_finite(&values) {
        return Ok(values);
    }
    Err(refused(format!(
        "the {what} holds what is no number; the positions or coefficients are far beyond those of a robot"
    )))
}

impl Model {
    /// The first model with a memory, if there is one.
    fn memory(&self) -> Option<String> {
        let model = &self.calibrated.model;
        let of_stacks = model.stacks().iter().flat_map(|stack| {
            [
                (stack.coulomb().state_len(), stack.coulomb().name()),
                (stack.hysteresis().state_len(), stack.hysteresis().name()),
                (stack.viscous().state_len(), stack.viscous().name()),
            ]
        });
        // A term without memory may keep what it asks for once.
        let remembers = |term: &&Box<dyn ArmTerm>| !term.invariants().contains(Invariant::Memoryless);
        let of_terms = model.arm_terms().iter().filter(remembers);
        let of_terms = of_terms.map(|term| (term.state_len(model.joints()), term.name()));
        of_stacks.chain(of_terms).find(|(states, _)| *states > 0).map(|(_, name)| name.to_owned())
    }
}
