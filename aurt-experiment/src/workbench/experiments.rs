//! The fit that an experiment asks for, and whether a model is of its robot.

use crate::Experiment;
use aurt::data::Loaded;
use aurt::fitting::{Assigned, Detail, Job};
use aurt::origins::Origins;
use aurt::{CalibratedModel, Outcome, Progress};
use aurt_calibration::TermScopes;
use aurt_plugins::Registry;
use aurt_rbd::geometry_difference;
use aurt_recording::{PreprocessOptions, Recording, RecordingError, RobotJoints};
use aurt_traits::{JointStack, MeasurementUnit};
use serde_json::json;

use crate::workbench::failure::Failure;

/// The friction of a joint: a Coulomb model times a hysteresis, and viscous friction of these powers.
pub fn friction(
    registry: &Registry,
    coulomb: &str,
    hysteresis: &str,
    powers: &[u32],
) -> Result<JointStack, Failure> {
    Ok(JointStack::new(
        registry.build_from_json(&json!({ "model": coulomb }))?,
        registry.build_from_json(&json!({ "model": hysteresis }))?,
        registry.build_from_json(&json!({ "model": "polynomial", "powers": powers }))?,
    )?)
}

/// The part of a recording that is used.
pub fn windowed(loaded: &Loaded) -> Result<Recording, RecordingError> {
    match loaded.source.window_s {
        Some(window) => loaded.recording.window(window),
        None => Ok(loaded.recording.clone().into()),
    }
}

/// The name of a part of a recording: two parts of one file are two recordings.
pub fn with_window(name: &str, window_s: Option<[f64; 2]>) -> String {
    match window_s {
        Some([from, to]) => format!("{name} from {from} to {to} s"),
        None => name.to_owned(),
    }
}

/// Measurements in the unit of a model: (raw − offset) · gain.
pub fn undone(measured: &[Vec<f64>], options: &PreprocessOptions) -> Vec<Vec<f64>> {
    let of = |all: &Option<Vec<f64>>, j: usize, otherwise: f64| {
        all.as_ref().and_then(|list| list.get(j)).copied().unwrap_or(otherwise)
    };
    let joint = |(j, series): (usize, &Vec<f64>)| {
        let (gain, offset) = (of(&options.gains, j, 1.0), of(&options.offsets, j, 0.0));
        series.iter().map(|raw| (raw - offset) * gain).collect()
    };
    measured.iter().enumerate().map(joint).collect()
}

/// Whether the model is of the robot of an experiment: as many joints, of the same names where both have names, the same
/// geometry under the same gravity, and drives of the same torque constants.
pub fn check_robot_of(calibrated: &CalibratedModel, experiment: &Experiment) -> Result<(), Failure> {
    let (ours, theirs) = (RobotJoints::of(&**calibrated.model.rigid_body()), experiment.robot.robot_joints());
    let named = !ours.names.is_empty() && !theirs.names.is_empty();
    let reason = if ours.count != theirs.count {
        format!("the model has {} joints, the experiment {}", ours.count, theirs.count)
    } else if named && ours.names != theirs.names {
        let listed = |joints: &RobotJoints| joints.names.join(", ");
        format!("the model's joints are {}, the experiment's {}", listed(&ours), listed(&theirs))
    } else {
        let model = &calibrated.model;
        let theirs = experiment.robot.rigid_body()?;
        match geometry_difference(&**model.rigid_body(), model.base(), &*theirs)? {
            Some(difference) => {
                format!("the model is of another robot than the experiment: {difference}, in this order")
            }
            None => match constants_difference(calibrated, experiment) {
                Some(difference) => difference,
                None => return Ok(()),
            },
        }
    };
    Err(Failure::argument(
        "--model",
        reason,
        "name the model that `aurt run` made of this experiment; if the joints have other names only, give those of \
                 the model under [robot]: joint_names = […]",
    ))
}

/// In what the drives of an experiment differ from those of a model: with other torque constants, currents are other torques.
fn constants_difference(calibrated: &CalibratedModel, experiment: &Experiment) -> Option<String> {
    let theirs = experiment.instrument.torque_constants_nm_per_a.as_ref()?;
    let ours = calibrated.instrument.torque_constants_nm_per_a.as_ref();
    let listed = |constants: &[f64]| constants.iter().map(f64::to_string).collect::<Vec<_>>().join(", ");
    match ours {
        None if calibrated.calibration.unit == MeasurementUnit::Ampere => {
            Some("the model is in A, the experiment has `torque_constants_nm_per_a`".to_owned())
        }
        Some(ours) if ours != theirs => Some(format!(
            "the model was made with the torque constants {} Nm/A, the experiment has {}",
            listed(ours),
            listed(theirs)
        )),
        _ => None,
    }
}

pub fn job(experiment: &Experiment) -> Result<Job, Failure> {
    Ok(Job {
        model: experiment.robot_model()?,
        preprocessing: experiment.preprocess.clone(),
        instrument: experiment.instrument.clone(),
        options: experiment.calibration,
        scopes: TermScopes::new(experiment.arm_term_recordings.clone()),
    })
}

/// Does what an experiment says, without writing anything.
pub fn fit_experiment(experiment: &Experiment, progress: &Progress) -> Result<Outcome, Failure> {
    fit_and_keep(experiment, progress).map(|(outcome, _)| outcome)
}

/// As [`fit_experiment`]; the recordings are kept, to be looked at again.
pub fn fit_and_keep(
    experiment: &Experiment,
    progress: &Progress,
) -> Result<(Outcome, Vec<Assigned>), Failure> {
    let recordings = &experiment.recordings;
    progress.step("compiling the model");
    let job = job(experiment)?;
    let assigned =
        job.read(recordings.calibration.iter().cloned(), recordings.validation.iter().cloned(), progress)?;
    let mut outcome = job.fit(&assigned, Detail::RowByRow, progress)?;
    outcome.calibrated.origins =
        Origins::of(Some(&experiment.source_text), assigned.iter().map(Assigned::origin));
    Ok((outcome, assigned))
}
