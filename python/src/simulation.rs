//! Simulated robots, and motions for them.

use aurt::simulation;
use aurt_experiment::workbench::failure::Failure;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::{Value, json};
use simulation::trajectory::{ExcitationOptions, MultiSineOptions};
use simulation::{Motion, ScenarioFile};

use crate::arrays::shaped;
use crate::error::{raised, refused};
use crate::recording::Recording;
use crate::rows::json_of;
use crate::settings::listener;
use crate::work;

/// Names of the robots that can be simulated.
#[pyfunction]
pub fn robots() -> Vec<String> {
    simulation::Robot::all().into_iter().map(|robot| robot.name).collect()
}

/// What the logger of a simulated robot records.
#[pyfunction]
#[pyo3(signature = (robot, *, motion=None, seed=1, effects=None, progress=None, **scenario))]
pub fn simulate(
    py: Python<'_>,
    robot: &str,
    motion: Option<&Bound<'_, PyAny>>,
    seed: u64,
    effects: Option<&Bound<'_, PyAny>>,
    progress: Option<&Bound<'_, PyAny>>,
    scenario: Option<&Bound<'_, PyDict>>,
) -> PyResult<Recording> {
    let mut document = match scenario {
        Some(scenario) => json_of("the scenario", scenario.as_any())?,
        None => json!({}),
    };
    document["robot"] = json!(robot);
    document["seed"] = json!(seed);
    document["motion"] = match motion {
        Some(motion) => json_of("motion", motion)?,
        None => {
            json!({"kind": "multi_sine", "duration_s": 15.0, "harmonics": 8, "top_hz": 1.0, "share": 0.6})
        }
    };
    if let Some(effects) = effects {
        document["effect"] = json_of("effects", effects)?;
    }
    let file: ScenarioFile =
        serde_json::from_value(document).map_err(|error| refused(format!("the scenario: {error}")))?;
    let progress = listener(progress)?;
    let recording = work::run(py, progress.as_ref(), move |progress| {
        progress.step("simulating the robot");
        Ok(aurt::simulate(&file.scenario()?)?)
    })?;
    Ok(Recording::of(recording))
}

/// A motion that makes a robot's parameters visible: a dict of t, q, dq, ddq and, if it was optimised, the condition number.
#[pyfunction]
#[pyo3(signature = (robot, *, motion=None, duration_s=20.0, harmonics=6, top_hz=0.6, share=0.8, tries=600, rate_hz=100.0, torque_limits=false, seed=1, progress=None))]
pub fn excite<'py>(
    py: Python<'py>,
    robot: &str,
    motion: Option<&Bound<'py, PyAny>>,
    duration_s: f64,
    harmonics: usize,
    top_hz: f64,
    share: f64,
    tries: usize,
    rate_hz: f64,
    torque_limits: bool,
    seed: u64,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let robot = simulation::Robot::named(robot).map_err(raised)?;
    if !(rate_hz.is_finite() && (1e-3..=1e5).contains(&rate_hz)) {
        return Err(refused(format!("rate_hz is {rate_hz}; it must lie between 0.001 and 100000")));
    }
    let asked: Option<Motion> = match motion {
        None => None,
        Some(motion) => Some(
            serde_json::from_value::<Motion>(json_of("motion", motion)?)
                .map_err(|error| refused(format!("motion: {error}")))?,
        ),
    };
    let progress = listener(progress)?;
    let joints = robot.joints();
    let (rows, condition) = work::run(py, progress.as_ref(), move |progress| {
        let (trajectory, condition) = match asked {
            Some(motion) => (motion.plan(&robot, seed)?, Value::Null),
            None => {
                let sines = MultiSineOptions { duration_s, harmonics, top_hz, share };
                let options = ExcitationOptions { sines, tries, torque_limits };
                let found = simulation::trajectory::excite(&robot, None, &options, seed, &mut |_, best| {
                    progress.step(format!("condition number {best:.1}"));
                })?;
                (found.trajectory, json!(found.condition_number))
            }
        };
        if torque_limits {
            trajectory.check_torque(&robot)?;
        }
        let samples = (trajectory.duration_s() * rate_hz + 1e-9) as usize + 1;
        let mut rows = [vec![0.0; samples], Vec::new(), Vec::new(), Vec::new()];
        let mut state = [vec![0.0; joints], vec![0.0; joints], vec![0.0; joints]];
        for k in 0..samples {
            let time_s = k as f64 / rate_hz;
            rows[0][k] = time_s;
            let [q, dq, ddq] = &mut state;
            trajectory.at(time_s, q, dq, ddq);
            for (all, now) in rows[1..].iter_mut().zip(&state) {
                all.extend_from_slice(now);
            }
        }
        Ok::<_, Failure>((rows, condition))
    })?;
    let [time_s, q, dq, ddq] = rows;
    let samples = time_s.len();
    let result = PyDict::new(py);
    result.set_item("t", PyArray1::from_vec(py, time_s))?;
    for (name, values) in [("q", q), ("dq", dq), ("ddq", ddq)] {
        let array: Bound<'py, PyArray2<f64>> = shaped(py, values, [samples, joints])?;
        result.set_item(name, array)?;
    }
    result.set_item("condition_number", condition.as_f64())?;
    Ok(result)
}
