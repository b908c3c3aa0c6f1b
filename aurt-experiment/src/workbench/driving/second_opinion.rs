//! What others fitted, judged by recordings: its error, what of it they determine, and what it stands for.

use std::fmt::Write;
use std::path::Path;

use crate::Experiment;
use aurt::Progress;
use aurt_calibration::drives::{
    Absorbed, DriveRecording, DrivenArm, EstimatedNumber, Mechanics, OutputErrorFit, Selection, absorbed,
    output_error, stem,
};
use aurt_calibration::with_deviation;
use aurt_diagnosis::drives::{Missed, STRUCTURES, Structure, compare, deciders};
use aurt_files::output::pretty;
use aurt_friction::drives::PdLaw;
use aurt_traits::RobotNames;
use serde_json::{Value, json};

use super::fits::{self, Fit};
use super::setting::Setting;
use super::{DriveOutcome, UNLIMITED, follows_positions, note_lines, of_joint, open_lines, values, warnings};
use crate::workbench::diagnosing::selection;
use crate::workbench::failure::Failure;

/// The keys of viscous friction: one column of a motion that does not saturate.
const VISCOUS: [&str; 4] = [
    "back_emf_nm_s_per_rad",
    "damping_nm_s_per_rad",
    "firmware_damping_nm_s_per_rad",
    "viscous_nm_s_per_rad",
];
/// Other keys that a fit can state and recordings determine.
const STATED: [&str; 7] = [
    "gain_nm_per_rad",
    "delay_s",
    "rotor_inertia_kg_m2",
    "coulomb_nm",
    "coulomb_per_load",
    "static_nm",
    "speed_limit_rad_s",
];

/// A structure that a number stands for: the structure's own number and value there, and its part of the change.
type Part = (Structure, String, f64, f64);

struct Number<'a> {
    given: f64,
    again: &'a EstimatedNumber,
    full: f64,
    /// What its change is split into, the largest first.
    stands_for: Vec<Part>,
}

impl Number<'_> {
    /// Whether recordings know it twice as well as it was known before.
    fn is_determined(&self) -> bool {
        !self.again.at_bound && self.again.deviation < 0.5 * self.again.start_deviation
    }

    fn change(&self) -> f64 {
        self.again.value - self.full
    }

    fn not_split(&self) -> f64 {
        self.change() - self.stands_for.iter().map(|s| s.3).sum::<f64>()
    }
}

/// Judges the drives and joints that others fitted by the recordings of an experiment; a file of `parameters` corrects them.
pub fn second_opinion(
    experiment: &Experiment,
    file: &Path,
    parameters: Option<&Path>,
    progress: &Progress,
) -> Result<DriveOutcome, Failure> {
    if !follows_positions(&Setting::of(experiment)?.arm) {
        let remedy = "use a [drive] that follows positions, and recordings of them";
        return Err(Failure::unfit(
            &experiment.path,
            "the drive follows no positions, as the fit's actuators do",
            remedy,
        ));
    }
    let robot_joints = experiment.robot.robot_joints();
    let names = RobotNames::of_joints(&robot_joints.names);
    let fit = fits::read(file, parameters, &robot_joints)?;
    let setting = Setting::read(experiment, progress)?;
    let Setting { arm, selection: estimated, options, .. } = &setting;
    let [fitted, held_out] = setting.parts();
    if held_out.is_empty() {
        let remedy = "list recordings under `validation`";
        return Err(Failure::unfit(&experiment.path, "no recording is held out to judge the fit by", remedy));
    }
    let failed = |error| setting.failed(&error);
    progress.step("the experiment's own model");
    let own = output_error(arm, estimated, &fitted, options).map_err(failed)?;
    let (given, more_lost) = given(&own.arm, &fit, names);
    given.validate().map_err(|e| Failure::unfit(file, e.to_string(), "correct the number; units are SI"))?;
    progress.step("the fit's own numbers, estimated again");
    let (start, selection_again) = again(&given, &own.arm, arm, estimated);
    let again = output_error(&start, &selection_again, &fitted, options).map_err(failed)?;
    progress.step("what they stand for");
    let parts = absorbed(&again.arm, &selection_again, &own.arm, &fitted, options).map_err(failed)?;
    let missed = |arm: &DrivenArm| Missed::of(arm, &held_out, options);
    let (theirs, ours) = (missed(&given), missed(&own.arm).map_err(failed)?);
    let level = selection(experiment)?.level;
    let probability = theirs.as_ref().map_or(0.0, |t| compare(&ours, t, options).probability);
    let (doubts, mut notes) = (setting.doubts(), setting.notes.clone());
    notes.extend(fit.lost.iter().chain(&more_lost).map(|lost| format!("{}: {lost}", fit.kind)));
    notes.extend(own.undetermined.iter().map(|open| format!("the own model: {open}")));
    let zeros = if fit.has_zeros { "" } else { ", zeros of the joints" };
    notes.push(format!("links, stops, loads{zeros} and the floor are those of the experiment"));
    let said = Said {
        kind: fit.kind,
        held_out: [
            ("the fit as it is given", theirs.ok().map(|m| m.rms_all_rad())),
            ("its numbers, estimated again", missed(&again.arm).ok().map(|m| m.rms_all_rad())),
            ("the command itself", Some(command_rms(&held_out))),
            ("the experiment's own model", Some(ours.rms_all_rad())),
        ],
        is_worse: probability <= level,
        probability,
        numbers: numbers(&given, &again, &own.arm, &parts),
        again: &again,
        notes: &notes,
        names,
    };
    let json = said.to_json(&doubts);
    Ok(DriveOutcome {
        text: said.text() + &warnings(&doubts),
        files: vec![("second_opinion.json".to_owned(), pretty(&json).into_bytes())],
        json,
        findings: said.is_worse || !doubts.is_empty(),
    })
}

/// The arm with the drives of a fit in the surroundings of `own`, and what its kind of drive has no number for.
pub(super) fn given(own: &DrivenArm, fit: &Fit, names: RobotNames<'_>) -> (DrivenArm, Vec<String>) {
    let (mut arm, mut lost) = (own.clone(), Vec::new());
    for (j, (joint, (servo, mechanics))) in arm.joints.iter_mut().zip(&fit.joints).enumerate() {
        let around = joint.mechanics;
        joint.mechanics = Mechanics {
            position_offset_rad: if fit.has_zeros { mechanics } else { &around }.position_offset_rad,
            mass_scale: around.mass_scale,
            lower_stop_rad: around.lower_stop_rad,
            upper_stop_rad: around.upper_stop_rad,
            ..*mechanics
        };
        if joint.drive.name() == "pd_law" {
            joint.mechanics.viscous_nm_s_per_rad += servo.back_emf_nm_s_per_rad;
            joint.mechanics.torque_offset_nm += servo.gain_nm_per_rad * servo.command_offset_rad;
            joint.drive = Box::new(PdLaw {
                gain_nm_per_rad: servo.gain_nm_per_rad,
                damping_nm_s_per_rad: servo.firmware_damping_nm_s_per_rad,
                delay_s: servo.delay_s,
                torque_limit_nm: servo.torque_limit_nm,
            });
            if servo.speed_limit_rad_s < UNLIMITED {
                lost.push(format!(
                    "{}: the speed limit {:.3} rad/s has no place in a pd_law",
                    names.joint(j),
                    servo.speed_limit_rad_s
                ));
            }
        } else {
            joint.drive = Box::new(*servo);
        }
    }
    (arm, lost)
}

/// The arm of the fit's structure at which its numbers start, and which they are: as the experiment has them where it estimates
/// them. What the experiment knows is not estimated.
fn again(
    given: &DrivenArm,
    own: &DrivenArm,
    described: &DrivenArm,
    selection: &Selection,
) -> (DrivenArm, Selection) {
    let names = given.names();
    let (theirs, mine, first) = (values(given), values(own), values(described));
    let is_own = |key: &str| selection.estimate.iter().any(|e| stem(e) == key);
    let acts = |key: &str, numbers: &[f64]| {
        names.iter().zip(numbers).any(|(name, n)| stem(name) == key && *n > 1e-6 && *n < 1e9)
    };
    let has = |key: &&str| names.iter().any(|name| stem(name) == *key);
    let viscous = VISCOUS.into_iter().find(|k| is_own(k)).or(VISCOUS.into_iter().find(has));
    let viscous = viscous.unwrap_or(VISCOUS[0]);
    let is_viscous = VISCOUS.into_iter().any(|k| acts(k, &theirs));
    let is_stated = |key: &str| if key == viscous { is_viscous } else { acts(key, &theirs) };
    let keys = || STATED.into_iter().chain([viscous]).filter(|key| is_stated(key));
    let known: Vec<&str> = keys().filter(|key| !is_own(key) && acts(key, &mine)).collect();
    let estimated: Vec<&str> = keys().filter(|key| !known.contains(key)).collect();
    let start = |k: usize| match stem(&names[k]) {
        key if known.contains(&key) => mine[k],
        key if estimated.contains(&key) && is_own(key) => first[k],
        key if key == viscous && is_viscous => total(given, own, viscous, k),
        key if VISCOUS.contains(&key) && key != viscous => mine[k],
        "stribeck_velocity_rad_s" => mine[k],
        _ => theirs[k],
    };
    let mut arm = given.clone();
    arm.set_numbers(&(0..names.len()).map(start).collect::<Vec<_>>());
    let estimate: Vec<String> = estimated.into_iter().map(str::to_owned).collect();
    let shared = selection.shared.iter().filter(|k| estimate.contains(k)).cloned().collect();
    (arm, Selection { estimate, shared, deviations: selection.deviations.clone() })
}

/// All viscous friction of the joint of a number, without what `own` has under the other keys.
fn total(given: &DrivenArm, own: &DrivenArm, viscous: &str, place: usize) -> f64 {
    let names = given.names();
    let joint = &names[place][stem(&names[place]).len()..];
    let of = |arm: &DrivenArm, key: &str| {
        let at = names.iter().position(|n| *n == format!("{key}{joint}"));
        at.map_or(0.0, |at| values(arm)[at])
    };
    let others = VISCOUS.iter().filter(|k| **k != viscous).map(|k| of(own, k)).sum::<f64>();
    (VISCOUS.iter().map(|k| of(given, k)).sum::<f64>() - others).max(0.0)
}

fn numbers<'a>(
    given: &DrivenArm,
    again: &'a OutputErrorFit,
    own: &DrivenArm,
    parts: &[Absorbed],
) -> Vec<Number<'a>> {
    let (names, theirs, ours) = (own.names(), values(given), values(own));
    let of = |number: &'a EstimatedNumber| {
        // One that joints share stands for that of the first.
        let place =
            names.iter().position(|n| *n == number.name || stem(n) == number.name).unwrap_or_default();
        let joint = &names[place][stem(&names[place]).len()..];
        let stands_for = parts.iter().filter_map(|part| {
            let structure = STRUCTURES.into_iter().rev().find(|s| s.has(&part.key))?;
            let name = format!("{}{joint}", part.key);
            let value = names.iter().position(|n| *n == name).map(|at| ours[at])?;
            let change = part.changes.iter().find(|c| c.0 == number.name)?.1;
            Some((structure, name, value, change))
        });
        let mut stands_for: Vec<_> = stands_for.filter(|s| s.3 != 0.0).collect();
        stands_for.sort_by(|a, b| b.3.abs().total_cmp(&a.3.abs()));
        let key = stem(&names[place]);
        let given = if VISCOUS.contains(&key) { total(given, own, key, place) } else { theirs[place] };
        Number { given, again: number, full: ours[place], stands_for }
    };
    again.numbers.iter().map(of).collect()
}

/// Root mean square of command − position over all joints.
fn command_rms(recordings: &[DriveRecording]) -> f64 {
    let (mut squares, mut count) = (0.0, 0_usize);
    for r in recordings {
        for (command, position) in r.command.iter().zip(&r.position_rad) {
            let errors = command.iter().zip(position).skip(r.first);
            squares += errors.map(|(c, q)| (c - q).powi(2)).sum::<f64>();
            count += position.len() - r.first;
        }
    }
    (squares / count.max(1) as f64).sqrt()
}

/// What a number of the fit stands for, in words.
fn sentence(n: &Number<'_>, parts: &[&Part], names: RobotNames<'_>) -> String {
    let list = |along: bool| -> Vec<String> {
        let own = parts.iter().filter(|p| (p.3 * n.change() > 0.0) == along);
        own.map(|(s, name, value, change)| {
            format!("{} ({} {value:.4}): {change:+.4}", s.title, of_joint(name, names))
        })
        .collect()
    };
    let said = match (n.not_split().abs() <= 0.5 * n.change().abs(), list(true), list(false)) {
        (false, ..) => "its change is not split: linear parts miss more than half of it".to_owned(),
        (true, along, against) if against.is_empty() => format!("it stands for {}", along.join(", ")),
        (true, along, against) => format!("it stands for {}, less {}", along.join(", "), against.join(", ")),
    };
    let (name, value, unit) = (of_joint(&n.again.name, names), n.again.value, &n.again.unit);
    format!(
        "{name} {value:.4} {unit}, {:.4} in the own model: {said}; not split {:+.4}",
        n.full,
        n.not_split()
    )
}

struct Said<'a> {
    kind: &'static str,
    /// Root mean squares of the held-out positions; none of a loop that diverges.
    held_out: [(&'static str, Option<f64>); 4],
    is_worse: bool,
    probability: f64,
    numbers: Vec<Number<'a>>,
    again: &'a OutputErrorFit,
    notes: &'a [String],
    names: RobotNames<'a>,
}

/// Parts of a change that are smaller than this of the largest are not said in words.
const SAID: f64 = 0.1;

impl Said<'_> {
    /// Numbers that change by more than two deviations and a twentieth with the structures that the fit lacks.
    fn absorbing(&self) -> impl Iterator<Item = (&Number<'_>, Vec<&Part>)> {
        let changes = |n: &&Number<'_>| {
            let least = (2.0 * n.again.deviation).max(0.05 * n.again.value.abs());
            !n.again.at_bound && n.change().abs() > least
        };
        self.numbers.iter().filter(changes).filter_map(|n| {
            let largest = n.stands_for.first()?.3.abs();
            Some((n, n.stands_for.iter().filter(|s| s.3.abs() >= SAID * largest).collect()))
        })
    }

    fn record(&self) -> Vec<&'static str> {
        let mut names: Vec<String> = self.again.undetermined.iter().flat_map(|u| u.names.clone()).collect();
        names.extend(self.absorbing().flat_map(|(_, parts)| parts.into_iter().map(|p| p.1.clone())));
        deciders(&names)
    }

    fn text(&self) -> String {
        let verdict = if self.is_worse {
            "the experiment's own model predicts better"
        } else {
            "the experiment's own model predicts no better"
        };
        let mut text = format!(
            "{} of others: {verdict} (p = {:.1e})\n\nrms of the held-out positions in 1e-3 rad or m\n",
            self.kind, self.probability
        );
        for (what, rms) in self.held_out {
            let rms = rms.map_or("diverges".into(), |rms| format!("{:.2}", 1e3 * rms));
            let _ = writeln!(text, "  {what:32} {rms:>8}");
        }
        let _ = writeln!(
            text,
            "\nits numbers{:24} {:>10} {:>21} {:>10}",
            "", "given", "estimated again", "own model"
        );
        for n in &self.numbers {
            let a = n.again;
            let open = if a.at_bound {
                "  at its bound"
            } else if n.is_determined() {
                ""
            } else {
                "  not determined"
            };
            let _ = writeln!(
                text,
                "  {:32} {:>10.4} {:>21} {:>10.4} {}{open}",
                of_joint(&a.name, self.names),
                n.given,
                with_deviation(a.value, a.deviation),
                n.full,
                a.unit
            );
        }
        let mut title = "\nwhat they stand for\n";
        for (n, parts) in self.absorbing() {
            let _ = writeln!(text, "{title}  {}", sentence(n, &parts, self.names));
            title = "";
        }
        text.push_str(&open_lines(&self.again.undetermined, |_| String::new()));
        let record = self.record();
        if !record.is_empty() {
            let _ = writeln!(text, "\nto tell, record {}", record.join("; "));
        }
        text + &note_lines(self.notes)
    }

    fn to_json(&self, doubts: &[String]) -> Value {
        let numbers = self.numbers.iter().map(|n| {
            let parts = n.stands_for.iter().map(|(s, name, value, change)| {
                json!({ "structure": s.id, "number": name, "value": value, "change": change })
            });
            json!({
                "name": n.again.name, "unit": n.again.unit, "given": n.given, "again": n.again.value,
                "deviation": n.again.deviation, "at_bound": n.again.at_bound, "determined": n.is_determined(),
                "own_model": n.full, "stands_for": parts.collect::<Vec<_>>(), "not_split": n.not_split(),
            })
        });
        let [given, again, command, own] = self.held_out.map(|h| h.1);
        json!({
            "schema": 1,
            "kind": "second_opinion",
            "fit": self.kind,
            "held_out_rms": { "given": given, "again": again, "command": command, "own_model": own },
            "own_model_predicts_better": self.is_worse,
            "p": self.probability,
            "numbers": numbers.collect::<Vec<_>>(),
            "undetermined": self.again.undetermined.iter().map(ToString::to_string).collect::<Vec<_>>(),
            "record": self.record(),
            "warnings": doubts,
            "notes": self.notes,
        })
    }
}
