//! Experiments with drives, and their recordings of commands and positions.

use std::path::PathBuf;

use crate::Experiment;
use aurt::data::{Loaded, Purpose, Source};
use aurt::duplicates::{SampleRegister, UsedSeries};
use aurt::{Progress, Role};
use aurt_calibration::drives::{DriveError, DriveRecording, DrivenArm, Options, Selection};
use aurt_rbd::{INERTIAL_PARAMETERS, RobotDescription};
use aurt_recording::{AngleUnit, RecordedAs, RobotJoints, RobotRecording};
use aurt_traits::{MeasurementUnit, RobotNames};

use super::{REMEDY, doubts, follows_positions};
use crate::workbench::failure::Failure;

pub(super) struct Read {
    pub(super) label: String,
    pub(super) file: PathBuf,
    pub(super) held_out: bool,
    pub(super) recording: DriveRecording,
    pub(super) notes: Vec<String>,
    pub(super) doubts: Vec<String>,
}

/// An experiment with drives: the arm, and the recordings once they are read.
pub(super) struct Setting<'e> {
    pub(super) experiment: &'e Experiment,
    pub(super) arm: DrivenArm,
    pub(super) selection: &'e Selection,
    pub(super) options: Options,
    pub(super) recordings: Vec<Read>,
    pub(super) notes: Vec<String>,
}

impl<'e> Setting<'e> {
    /// The arm that an experiment describes.
    pub(super) fn of(experiment: &'e Experiment) -> Result<Self, Failure> {
        let Some(drive) = &experiment.drive else {
            let reason = "the experiment describes no drive";
            return Err(Failure::unfit(&experiment.path, reason, "add [drive]"));
        };
        let robot = &experiment.robot;
        let mut notes = robot.geometry.notes();
        notes.extend(experiment.notes.clone());
        let chain = robot.geometry.chain(robot.gravity_m_s2)?;
        let standard_parameters = match robot.geometry.standard_parameters() {
            Some(standard) => standard.to_vec(),
            None => {
                notes.push("the robot's description states no masses: all inertia is that of the rotors, and there is no gravity".into());
                vec![0.0; INERTIAL_PARAMETERS * chain.joints().len()]
            }
        };
        let (joints, command, floor) = (drive.joints.clone(), drive.command, drive.floor);
        Ok(Self {
            experiment,
            arm: DrivenArm { chain, standard_parameters, joints, command, floor },
            selection: &drive.selection,
            options: options_of(experiment),
            recordings: Vec::new(),
            notes,
        })
    }

    /// The same with its recordings.
    pub(super) fn read(experiment: &'e Experiment, progress: &Progress) -> Result<Self, Failure> {
        let mut setting = Self::of(experiment)?;
        setting.recordings = read_all(experiment, &setting.arm, &mut setting.notes, progress)?;
        Ok(setting)
    }

    pub(super) fn all(&self) -> Vec<DriveRecording> {
        self.recordings.iter().map(|r| r.recording.clone()).collect()
    }

    /// The fitted recordings, and the held-out ones.
    pub(super) fn parts(&self) -> [Vec<DriveRecording>; 2] {
        let of = |held_out: bool| {
            let own = self.recordings.iter().filter(move |r| r.held_out == held_out);
            own.map(|r| r.recording.clone()).collect()
        };
        [of(false), of(true)]
    }

    pub(super) fn failed(&self, error: &DriveError) -> Failure {
        of_drive(error, self.experiment, &self.recordings)
    }

    pub(super) fn doubts(&self) -> Vec<String> {
        let of =
            |r: &'_ Read| r.doubts.iter().map(|doubt| format!("{}: {doubt}", r.label)).collect::<Vec<_>>();
        self.recordings.iter().flat_map(of).collect()
    }
}

/// Reads the recordings that an experiment lists.
pub(super) fn read_all(
    experiment: &Experiment,
    arm: &DrivenArm,
    notes: &mut Vec<String>,
    progress: &Progress,
) -> Result<Vec<Read>, Failure> {
    let joints = experiment.robot.robot_joints();
    let listed: Vec<(&Source, Role)> = experiment.recordings.fitted_and_held_out().collect();
    refuse_overlap(experiment, &listed)?;
    let mut recordings = Vec::new();
    let mut samples = SampleRegister::default();
    for (source, role) in listed {
        progress.step(format!("reading {}", source.label));
        let read = read(source.clone(), &joints, arm)?;
        notes.extend(read.notes.iter().map(|note| format!("{}: {note}", read.label)));
        samples.add(&UsedSeries {
            label: &read.label,
            role: role.name(),
            time_s: &read.recording.time_s,
            motion: &read.recording.command,
            measured: &read.recording.position_rad,
            rows: 0..read.recording.time_s.len(),
        })?;
        recordings.push(Read { held_out: role == Role::Validation, ..read });
    }
    Ok(recordings)
}

/// Refuses rows that are listed twice: held out and fitted they judge nothing, fitted twice they count twice.
fn refuse_overlap(experiment: &Experiment, listed: &[(&Source, Role)]) -> Result<(), Failure> {
    let file = |r: &Source| std::fs::canonicalize(&r.file).unwrap_or_else(|_| r.file.clone());
    let window = |r: &Source| r.window_s.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
    for (k, (later, role)) in listed.iter().enumerate() {
        let overlaps = |(earlier, _): &&(&Source, Role)| {
            let ([begin, end], [other_begin, other_end]) = (window(later), window(earlier));
            let is_same = file(later) == file(earlier) && later.recorded.take == earlier.recorded.take;
            is_same && begin.max(other_begin) < end.min(other_end)
        };
        let Some((_, other_role)) = listed[..k].iter().find(overlaps) else { continue };
        let both = if role == other_role { "twice" } else { "fitted and held out" };
        let reason = format!("rows of {} are listed {both}", later.label);
        let remedy = "list other recordings, or parts that do not overlap with `window_s`";
        return Err(Failure::unfit(&experiment.path, reason, remedy));
    }
    Ok(())
}

pub(super) fn options_of(experiment: &Experiment) -> Options {
    let (default, drive) = (Options::default(), experiment.drive.as_ref());
    Options {
        piece_s: drive.and_then(|d| d.piece_s),
        deviation_rad: drive.and_then(|d| d.position_deviation_rad).unwrap_or(default.deviation_rad),
        ..default
    }
}

pub(super) fn of_drive(error: &DriveError, experiment: &Experiment, recordings: &[Read]) -> Failure {
    let fitted: Vec<&Read> = recordings.iter().filter(|r| !r.held_out).collect();
    match error {
        DriveError::Recording { recording, reason } if fitted.get(*recording).is_some() => {
            Failure::unfit(&fitted[*recording].file, reason.clone(), REMEDY)
        }
        _ => Failure::unfit(&experiment.path, error.to_string(), "see [drive] of the experiment"),
    }
}

/// Reads commands, which stand where a measurement does elsewhere, and positions.
pub(super) fn read(mut source: Source, joints: &RobotJoints, arm: &DrivenArm) -> Result<Read, Failure> {
    let RecordedAs { angle, counts_per_revolution, gear_ratio, .. } = &source.recorded;
    let follows = follows_positions(arm);
    if follows && (counts_per_revolution.is_some() || gear_ratio.is_some()) {
        return Err(Failure::unfit(
            &source.file,
            "`counts_per_revolution` and `gear_ratio` convert positions, and not the commands that they follow",
            "write commands and positions in rad or degrees at the joint",
        ));
    }
    let in_degrees = follows && *angle == Some(AngleUnit::Degree);
    // The unit of a command is that of the drive.
    source.unit = source.unit.or(Some(MeasurementUnit::NewtonMetre));
    let loaded = Loaded::read(source, Some(joints), Purpose::Calibration)?;
    let mut recording = cut(&loaded.recording, loaded.source.window_s)
        .ok_or_else(|| Failure::unfit(&loaded.source.file, "the recording holds no command", REMEDY))?;
    if in_degrees {
        let turning = recording.command.iter_mut().enumerate().filter(|(joint, _)| !joints.slides(*joint));
        turning.flat_map(|(_, command)| command).for_each(|c| *c = c.to_radians());
    }
    recording
        .check(joints.count, 0)
        .map_err(|e| Failure::unfit(&loaded.source.file, e.to_string(), REMEDY))?;
    let names = RobotNames::of_joints(&joints.names);
    if let Some(reason) = doubts::unsigned(&recording, arm, names) {
        let remedy = "log currents with their sign, or use the model of the command that the drive follows";
        return Err(Failure::unfit(&loaded.source.file, reason, remedy));
    }
    let notes = loaded.recording.report.notes();
    let doubts = if follows { doubts::doubts(&recording, arm.command, names) } else { Vec::new() };
    Ok(Read {
        label: loaded.source.label,
        file: loaded.source.file,
        held_out: false,
        recording,
        notes,
        doubts,
    })
}

fn cut(recording: &RobotRecording, window_s: Option<[f64; 2]>) -> Option<DriveRecording> {
    let begin_s = *recording.time_s.first()?;
    let mut kept: Vec<usize> = (0..recording.time_s.len()).collect();
    // Stamps that repeat say nothing of what came between.
    kept.dedup_by(|b, a| recording.time_s[*b] <= recording.time_s[*a]);
    let of = |series: &Vec<Vec<f64>>| series.iter().map(|s| kept.iter().map(|k| s[*k]).collect()).collect();
    let whole = DriveRecording {
        time_s: kept.iter().map(|k| recording.time_s[*k] - begin_s).collect(),
        command: of(recording.measurement.as_ref()?),
        position_rad: of(&recording.position_rad),
        ..DriveRecording::default()
    };
    let Some([begin, end]) = window_s else { return Some(whole) };
    let before = |edge: &dyn Fn(f64) -> bool| whole.time_s.partition_point(|t| edge(*t));
    Some(whole.part(before(&|t| t < begin)..before(&|t| t <= end)))
}
