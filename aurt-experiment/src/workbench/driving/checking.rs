//! `aurt check` of an experiment with a `[drive]`: doubts about its recordings, and the command between two rows.

use std::fmt::Write;

use crate::Experiment;
use aurt::Progress;
use aurt_calibration::drives::{DriveRecording, DrivenArm, OutputErrorFit, Selection, output_error, stem};
use aurt_calibration::with_deviation;
use aurt_diagnosis::drives::{Missed, compare};
use aurt_traits::{CommandSignal, RobotNames};
use serde_json::json;

use super::doubts::{of_rollouts, rows_per_command};
use super::gravity::{LEVEL, upside_down};
use super::setting::{Read, Setting};
use super::{DriveOutcome, Judged, note_lines, warnings};
use crate::workbench::failure::Failure;

/// Checks the recordings of an experiment and tells how its commands act between two rows: the drive is estimated with commands
/// that hold and with commands on the line between two, both with a delay, and the positions of all recordings decide: both have
/// the same numbers to fit.
pub fn check_drives(experiment: &Experiment, progress: &Progress) -> Result<DriveOutcome, Failure> {
    let setting = Setting::read(experiment, progress)?;
    let (all, [fitted, _]) = (setting.all(), setting.parts());
    let (options, recordings, notes) = (&setting.options, &setting.recordings, &setting.notes);
    let selection = with_delay(setting.selection);
    let estimated = |(command, name)| -> Result<(&str, OutputErrorFit, Missed), Failure> {
        progress.step(format!("estimating with command = \"{name}\""));
        let failed = |error| setting.failed(&error);
        let arm = DrivenArm { command, ..setting.arm.clone() };
        let fit = output_error(&arm, &selection, &fitted, options).map_err(failed)?;
        let missed = Missed::of(&fit.arm, &all, options).map_err(failed)?;
        Ok((name, fit, missed))
    };
    let (hold, linear) =
        (&estimated((CommandSignal::Hold, "hold"))?, &estimated((CommandSignal::Linear, "linear"))?);
    let written = if setting.arm.command == CommandSignal::Hold { hold.0 } else { linear.0 };
    let p =
        [compare(&hold.2, &linear.2, options), compare(&linear.2, &hold.2, options)].map(|c| c.probability);
    let told = if p[0] <= LEVEL {
        Some(hold.0)
    } else if p[1] <= LEVEL {
        Some(linear.0)
    } else {
        None
    };
    let mut doubts = setting.doubts();
    if let Some(told) = told.filter(|told| *told != written) {
        doubts.push(format!(
            "the positions are those of command = \"{told}\" (p = {:.1e}), and [drive] has \"{written}\": write `command = \"{told}\"`",
            p[0].min(p[1])
        ));
    }
    let nearer = if linear.2.rms_all_rad() < hold.2.rms_all_rad() { linear } else { hold };
    doubts.extend(of_fit(&nearer.1, &setting, &all)?);
    let stairs = recordings.iter().filter_map(|r| rows_per_command(&r.recording)).fold(f64::NAN, f64::max);
    let mut text = format!(
        "{} recordings of commands and positions\n\nthe command between two rows\n",
        recordings.len()
    );
    if stairs.is_finite() {
        let _ = writeln!(
            text,
            "  it changes with every {stairs:.1}th row while it moves: it is sent less often than recorded, and holds"
        );
    }
    for (name, fit, missed) in [hold, linear] {
        let delay = fit.numbers.iter().find(|n| stem(&n.name) == "delay_s");
        let delay = delay.map_or_else(String::new, |d| {
            format!(", {} {} ms", d.name, with_deviation(1e3 * d.value, 1e3 * d.deviation))
        });
        let _ = writeln!(
            text,
            "  {name:8} rms of the positions {:.2}e-3 rad or m{delay}",
            1e3 * missed.rms_all_rad()
        );
    }
    let _ = match told {
        Some(told) => writeln!(text, "  the positions are those of \"{told}\" (p = {:.1e})", p[0].min(p[1])),
        None => writeln!(
            text,
            "  both meet the positions alike: \"{written}\" of [drive] is taken; a command that is held looks like one that comes half \
             a row later"
        ),
    };
    text.push_str(&note_lines(notes));
    let by_signal = [hold, linear].into_iter().map(|(name, fit, missed)| {
        let numbers =
            fit.numbers.iter().map(|n| json!({ "name": n.name, "value": n.value, "deviation": n.deviation }));
        json!({ "command": name, "rms": missed.rms_rad, "numbers": numbers.collect::<Vec<_>>() })
    });
    let json = json!({
        "kind": "drive",
        "command_in_experiment": written,
        "command_of_recordings": told,
        "p_hold": p[0],
        "p_linear": p[1],
        "rows_per_command": Some(stairs).filter(|s| s.is_finite()),
        "signals": by_signal.collect::<Vec<_>>(),
        "warnings": doubts,
        "notes": notes,
    });
    let findings = !doubts.is_empty();
    Ok(DriveOutcome { text: text + &warnings(&doubts), json, files: Vec::new(), findings })
}

/// What speaks against the drives that were estimated: rollouts that explain little, gravity.
fn of_fit(
    fit: &OutputErrorFit,
    setting: &Setting<'_>,
    all: &[DriveRecording],
) -> Result<Vec<String>, Failure> {
    let failed = |error| setting.failed(&error);
    let judge =
        |read: &Read| Ok(Judged::of(&fit.arm, read, &fit.arm.rollout(&read.recording).map_err(failed)?));
    let judged = setting.recordings.iter().map(judge).collect::<Result<Vec<_>, Failure>>()?;
    let names = RobotNames::of_joints(&setting.experiment.robot.joint_names);
    let mut doubts = of_rollouts(&judged, setting.options.deviation_rad, names);
    doubts.extend(upside_down(&fit.arm, all, &setting.options).map_err(failed)?);
    Ok(doubts)
}

/// The selection with a delay, without which commands that hold stand for one.
fn with_delay(selection: &Selection) -> Selection {
    let mut selection = selection.clone();
    if !selection.estimate.iter().any(|key| stem(key) == "delay_s") {
        selection.estimate.push("delay_s".to_owned());
        selection.shared.push("delay_s".to_owned());
    }
    selection
}
