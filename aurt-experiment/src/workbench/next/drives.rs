//! The next motion of commands for arms with drives, of which no torque is recorded.

use aurt::Progress;
use aurt_calibration::drives::{DriveRecording, stem};
use aurt_diagnosis::discrimination::DriveDiscrimination;
use aurt_traits::{Command, MeasurementUnit, RobotNames};

use super::keep_out::KeepOutCheck;
use super::limits::{JointMotion, limits_of};
use super::{Next, NextOptions, PlannedArm, Planner, rate_hz};
use crate::Experiment;
use crate::workbench::driving::DiagnosedSetting;
use crate::workbench::failure::Failure;

/// Time over which speeds of commands are taken, s, or a row where rows are farther apart: that between two commands of a host
/// whose log has more rows.
const OVER_S: f64 = 0.02;

pub(super) fn plan(
    experiment: &Experiment,
    options: &NextOptions,
    check: Option<&KeepOutCheck>,
    progress: &Progress,
) -> Result<Next, Failure> {
    if let Some(drive) = &experiment.drive {
        if !drive.joints.iter().all(|joint| joint.drive.command() == Command::Position) {
            let reason =
                "its drives do not follow positions, and a motion is planned as commands of positions";
            return Err(Failure::unfit(&experiment.path, reason, "`aurt diagnose` says what to record"));
        }
        let estimated = &drive.selection.estimate;
        let is_estimated =
            |name: &str| estimated.iter().any(|e| e == name || stem(name) == e || stem(e) == name);
        if let Some(wanted) = options.wanted.iter().find(|wanted| !is_estimated(&wanted.parameter)) {
            let remedy =
                format!("name one of {}; `gain_nm_per_rad_2` is that of joint 2", estimated.join(", "));
            let reason = format!("`{}` is not estimated", wanted.parameter);
            return Err(Failure::argument("--until", reason, remedy));
        }
    }
    let asked = DiagnosedSetting::of(experiment, &options.diagnosis.without, progress)?;
    let [fitted, held_out] = &asked.parts;
    let names = RobotNames::of_joints(&experiment.robot.joint_names);
    let recordings: Vec<&DriveRecording> = fitted.iter().chain(held_out).collect();
    let joints = recordings.first().map_or(0, |r| r.command.len());
    let shown = "positions, speeds and accelerations of the commands";
    let motions = (0..joints).map(|j| commanded(&recordings, j)).collect();
    let (limits, mut notes) = limits_of(options, motions, names, shown)?;
    notes.push(
        "record this motion twice: list one recording under `calibration` and one under `validation`".into(),
    );
    notes.extend(asked.doubts());
    let distance = |r: &DriveRecording, j: usize| {
        let pairs = r.position_rad[j].iter().zip(&r.command[j]);
        pairs.fold(0.0_f64, |most, (q, c)| most.max((q - c).abs()))
    };
    let arm = PlannedArm {
        joint_names: experiment.robot.joint_names.clone(),
        limits,
        rate_hz: rate_hz(recordings.first().map_or(&[][..], |r| &r.time_s)),
        recorded: (0..joints)
            .map(|j| recordings.iter().map(|r| distance(r, j)).fold(0.0, f64::max))
            .collect(),
        bodies: asked.chain(),
        unit: MeasurementUnit::NewtonMetre,
        is_of_drives: true,
        notes,
    };
    progress.step("models that the diagnosis leaves open");
    let doubts =
        DriveDiscrimination::new(&asked.found, [fitted, held_out], &options.wanted, options.duration_s);
    let doubts = doubts.map_err(aurt_diagnosis::DiagnosisError::from).map_err(aurt::Error::from)?;
    Planner { discrimination: &doubts, options, check, arm }.plan(progress)
}

/// Where the commands of a joint were, how fast they were and how much their speeds changed, each over [`OVER_S`]: a command that
/// is held jumps at its rows.
fn commanded(recordings: &[&DriveRecording], joint: usize) -> JointMotion {
    let (mut range, mut velocity, mut acceleration) = ([f64::INFINITY, f64::NEG_INFINITY], 0.0_f64, 0.0_f64);
    for recording in recordings {
        let command = &recording.command[joint];
        range = command.iter().fold(range, |[low, high], c| [low.min(*c), high.max(*c)]);
        let over = (OVER_S * rate_hz(&recording.time_s)).round().max(1.0) as usize;
        let over_s = over as f64 / rate_hz(&recording.time_s);
        let speeds: Vec<f64> =
            (over..command.len()).map(|k| (command[k] - command[k - over]) / over_s).collect();
        velocity = speeds.iter().fold(velocity, |most, v| most.max(v.abs()));
        let changes = (over..speeds.len()).map(|k| (speeds[k] - speeds[k - over]).abs() / over_s);
        acceleration = changes.fold(acceleration, f64::max);
    }
    (range, velocity, acceleration)
}
