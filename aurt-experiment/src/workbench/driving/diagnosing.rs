//! `aurt diagnose` of an experiment with a `[drive]`.

use std::fmt::Write;

use crate::Experiment;
use aurt::Progress;
use aurt_calibration::drives::{DriveRecording, Options};
use aurt_calibration::with_deviation;
use aurt_diagnosis::drives::{
    Answer, Comparison, Demands, Diagnosis, Finding, Objection, Structure, deciders, diagnose, is_beyond,
};
use aurt_diagnosis::{Remainder, Rest, SelectionOptions};
use aurt_files::output::pretty;
use aurt_rbd::SerialChain;
use aurt_traits::RobotNames;
use serde_json::{Value, json};

use super::rival::rests;
use super::setting::Setting;
use super::{CalibratedDrive, DriveOutcome, REMEDY, note_lines, of_joint, open_lines, warnings};
use crate::workbench::diagnosing::selection;
use crate::workbench::failure::Failure;

/// The file of the model with what a diagnosis found to be missing.
pub const IMPROVED_DRIVE_FILE: &str = "drive_improved.json";
/// What has no model yet.
const NOT_EXAMINED: &str = "play, elasticity, temperature, a sagging supply";
/// A rest beyond this many times what the model is expected to miss is something that it lacks.
const EXPECTED: f64 = 2.0;
/// Less than this share of what the model is expected to miss is of the simulation's steps, not of the robot.
const NUMERICAL: f64 = 0.01;

/// An experiment whose drives were diagnosed.
pub(in crate::workbench) struct DiagnosedSetting<'e> {
    setting: Setting<'e>,
    demands: Demands,
    pub(in crate::workbench) found: Diagnosis,
    /// The fitted recordings, and the held-out ones.
    pub(in crate::workbench) parts: [Vec<DriveRecording>; 2],
}

impl<'e> DiagnosedSetting<'e> {
    pub(in crate::workbench) fn of(
        experiment: &'e Experiment,
        without: &[String],
        progress: &Progress,
    ) -> Result<Self, Failure> {
        Setting::of(experiment)?;
        if let Some(target) = experiment.recordings.target.first() {
            let reason = format!(
                "{} is a target; positions of servo arms are not compared between recordings",
                target.label
            );
            let remedy = "list it under `calibration` in an experiment of its own, and compare what its drives and joints need";
            return Err(Failure::unfit(&experiment.path, reason, remedy));
        }
        let SelectionOptions { level, reduction, .. } = selection(experiment)?;
        let setting = Setting::read(experiment, progress)?;
        let parts = setting.parts();
        let [fitted, held_out] = &parts;
        let demands = Demands { level, reduction, without: without.to_vec() };
        let step = |what: &str| progress.step(what.to_owned());
        let (options, selection) = (&setting.options, setting.selection);
        let found = diagnose(&setting.arm, selection, [fitted, held_out], options, &demands, step)
            .map_err(|error| setting.failed(&error))?;
        Ok(Self { setting, demands, found, parts })
    }

    pub(in crate::workbench) fn chain(&self) -> &SerialChain {
        &self.setting.arm.chain
    }

    pub(in crate::workbench) fn doubts(&self) -> Vec<String> {
        self.setting.doubts()
    }
}

/// Says which structures the held-out recordings need, which the experiment's model lacks, and whether more is missing.
pub fn diagnose_drives(
    experiment: &Experiment,
    without: &[String],
    progress: &Progress,
) -> Result<DriveOutcome, Failure> {
    let DiagnosedSetting { setting, demands, found, parts: [fitted, held_out] } =
        DiagnosedSetting::of(experiment, without, progress)?;
    let options = &setting.options;
    let rolled = |recordings: &'_ [DriveRecording]| -> Result<Vec<Vec<Vec<f64>>>, Failure> {
        let one = |r: &DriveRecording| rollout(&found, r, options);
        recordings
            .iter()
            .map(|r| one(r).map_err(|e| Failure::unfit(&experiment.path, e.to_string(), REMEDY)))
            .collect()
    };
    progress.step("what a black box predicts of the rest");
    let rests = rests(
        &fitted.iter().zip(rolled(&fitted)?).collect::<Vec<_>>(),
        &held_out.iter().zip(rolled(&held_out)?).collect::<Vec<_>>(),
    );
    let missed = &found.missed_improved.rms_rad;
    let rests: Vec<Remainder> = rests
        .into_iter()
        .map(|rest| {
            let rms = missed[rest.joint];
            rest.against(options.deviation_rad, rms)
        })
        .collect();
    let improved = CalibratedDrive::of(experiment, found.improved.arm.clone());
    let said = Said { found: &found, rests: &rests, setting: &setting, names: improved.names() };
    let doubts = setting.doubts();
    let mut json = said.to_json(&demands);
    json["warnings"] = json!(doubts);
    let files = vec![
        ("verdict.json".to_owned(), pretty(&json).into_bytes()),
        ("structures.csv".to_owned(), said.table().into_bytes()),
        (IMPROVED_DRIVE_FILE.to_owned(), improved.to_file(experiment)?),
    ];
    let findings = said.verdict() != "no_mismatch" || !doubts.is_empty();
    Ok(DriveOutcome { text: said.text(&demands) + &warnings(&doubts), json, files, findings })
}

/// Positions of the improved model: by pieces where the estimate is.
fn rollout(
    found: &Diagnosis,
    recording: &DriveRecording,
    options: &Options,
) -> Result<Vec<Vec<f64>>, aurt_calibration::drives::DriveError> {
    let mut all = vec![Vec::new(); recording.command.len()];
    for piece in recording.pieces(options.piece_s)? {
        let simulated = found.improved.arm.rollout(&piece)?;
        // A piece ends with the sample at which the next one starts.
        all.iter_mut().zip(&simulated).for_each(|(a, s)| {
            a.pop();
            a.extend(s);
        });
    }
    Ok(all)
}

struct Said<'a> {
    found: &'a Diagnosis,
    rests: &'a [Remainder],
    setting: &'a Setting<'a>,
    names: RobotNames<'a>,
}

impl Said<'_> {
    /// True where more is left than the model is expected to miss, or a black box predicts as much.
    fn something_is_left(&self) -> bool {
        self.found.missed_improved.rms_all_rad() > EXPECTED * self.setting.options.deviation_rad
            || self.rests.iter().any(|r| r.rest == Rest::Something)
    }

    /// The joints that the improved model misses by more in the held-out recordings than twice its largest miss of a fitted one,
    /// with both, rad.
    fn held_out_differ(&self) -> Vec<(usize, [f64; 2])> {
        let least = NUMERICAL * self.setting.options.deviation_rad;
        let fitted = |j: usize| self.found.improved.rms_rad.iter().map(|r| r[j]).fold(least, f64::max);
        let held_out = self.found.missed_improved.rms_rad.iter().enumerate();
        held_out
            .map(|(j, rms)| (j, [*rms, fitted(j)]))
            .filter(|(_, [held_out, fitted])| *held_out > EXPECTED * fitted)
            .collect()
    }

    fn verdict(&self) -> &'static str {
        let is_named =
            self.found.findings.iter().any(|f| matches!(f.answer, Answer::Missing | Answer::Wrong));
        match (is_named, self.something_is_left()) {
            (false, false) if !self.held_out_differ().is_empty() => "held_out_differs",
            (false, false) => "no_mismatch",
            (true, false) => "named",
            (true, true) => "partly_explained",
            (false, true) => "unexplained",
        }
    }

    fn in_words(&self) -> &'static str {
        match self.verdict() {
            "no_mismatch" => "nothing is missing",
            "held_out_differs" => {
                "nothing is missing in the fitted recordings; the held-out ones differ from them"
            }
            "named" => "something is missing, and it is named",
            "partly_explained" => "something is missing; a part of it is named",
            _ => "something is missing, and no known structure explains it",
        }
    }

    fn text(&self, demands: &Demands) -> String {
        let (before, after) = (&self.found.missed, &self.found.missed_improved);
        let held_out: Vec<&str> =
            self.setting.recordings.iter().filter(|r| r.held_out).map(|r| r.label.as_str()).collect();
        let mut text = format!(
            "{}\n\njudged on {} held-out recordings; rms of the position over all joints {:.2}e-3 rad or m\n",
            self.in_words(),
            held_out.len(),
            1e3 * before.rms_all_rad(),
        );
        for (joint, [held_out, fitted]) in self.held_out_differ() {
            let _ = writeln!(
                text,
                "{} is missed by {:.2}e-3 there, and by at most {:.2}e-3 in fitted recordings",
                self.names.joint(joint),
                1e3 * held_out,
                1e3 * fitted
            );
        }
        for (answer, title) in [
            (Answer::Missing, "missing: adding it predicts better"),
            (Answer::Wrong, "given wrong: with other numbers it predicts better"),
            (Answer::Needed, "needed: without it, predictions are worse"),
            (Answer::NotSupported, "not supported: these recordings do not show it"),
        ] {
            let own: Vec<&Finding> = self.found.findings.iter().filter(|f| f.answer == answer).collect();
            if own.is_empty() {
                continue;
            }
            let _ = write!(
                text,
                "\n{title}\n  {:24} {:>8} {:>8} {:>7} {:>17} {:>8} {:>9}\n",
                "", "rms with", "without", "error", "nats/s", "p", "blocks"
            );
            own.iter().for_each(|f| line(f, demands, self.names, &mut text));
        }
        text.push_str(&open_lines(&self.found.improved.undetermined, |open| {
            format!("; record {}", deciders(&open.names).join(", "))
        }));
        let _ = write!(
            text,
            "\nremainder\n  rms {:.2}e-3 with what is missing, expected {:.2}e-3\n",
            1e3 * after.rms_all_rad(),
            1e3 * self.setting.options.deviation_rad,
        );
        for rest in self.rests {
            let predicted = rest.predictable.map_or_else(
                || "too little data to try boosted trees".into(),
                |share| {
                    let (value, std) = (100.0 * share.value.max(0.0), 100.0 * share.std);
                    format!("boosted trees predict {value:.0} ± {std:.0} % of it")
                },
            );
            let features: Vec<&str> = rest.follows.iter().map(|f| f.feature.as_str()).collect();
            let follows = match (rest.rest, features.join(", ")) {
                (Rest::Something, by) if by.is_empty() => ": something that the model lacks".to_owned(),
                (Rest::Something, by) => format!(": something that the model lacks, by {by}"),
                (Rest::Expected, _) => ": less than the model is expected to miss".to_owned(),
                _ => String::new(),
            };
            let _ = writeln!(
                text,
                "  {}: rms {:.2}e-3, {predicted}{follows}",
                self.names.joint(rest.joint),
                1e3 * after.rms_rad[rest.joint]
            );
        }
        let _ = writeln!(text, "  not examined: {NOT_EXAMINED}");
        text + &note_lines(&self.setting.notes)
    }

    fn table(&self) -> String {
        let mut text =
            "structure,answer,in_model,rms_with_rad,rms_without_rad,reduction,gain_nats_per_s,gain_deviation,p,blocks,objection\n"
                .to_owned();
        for f in &self.found.findings {
            let c = &f.comparison;
            let [with, without] = c.rms_rad;
            let numbers = [with, without, c.reduction, c.gain_per_s, c.deviation, c.probability].map(cell);
            let (id, answer) = (f.structure.id, word(f.answer));
            let objection = f.objection.map_or("", short);
            let _ = writeln!(
                text,
                "{id},{answer},{},{},{},{objection}",
                f.is_in_model,
                numbers.join(","),
                c.blocks
            );
        }
        text
    }

    fn to_json(&self, demands: &Demands) -> Value {
        let findings = self.found.findings.iter().map(|f| {
            let c = &f.comparison;
            let numbers = f.numbers.iter().map(|n| json!({ "name": n.name, "value": n.value, "deviation": n.deviation, "unit": n.unit, "at_bound": n.at_bound }));
            json!({
                "id": f.structure.id, "title": f.structure.title, "answer": word(f.answer), "objection": f.objection.map(short), "in_model": f.is_in_model,
                "numbers": numbers.collect::<Vec<_>>(), "alternatives": f.alternatives, "record": f.structure.decider,
                "evidence": { "gain_nats_per_s": c.gain_per_s, "deviation": c.deviation, "p": c.probability,
                    "reduction": c.reduction, "blocks": c.blocks, "all_blocks": c.all_blocks, "held_out_rms_with": c.rms_rad[0], "held_out_rms_without": c.rms_rad[1] },
            })
        });
        let undetermined = self.found.improved.undetermined.iter();
        let undetermined = undetermined
            .map(|u| json!({ "says": u.to_string(), "numbers": u.names, "record": deciders(&u.names) }));
        json!({
            "schema": 2,
            "kind": "drive",
            "verdict": self.verdict(),
            "settings": { "level": demands.level, "reduction": demands.reduction, "without": demands.without },
            "structures": findings.collect::<Vec<_>>(),
            "undetermined": undetermined.collect::<Vec<_>>(),
            "held_out": {
                "rms": self.found.missed.rms_rad, "rms_improved": self.found.missed_improved.rms_rad,
                "differ": self.held_out_differ().iter().map(|(joint, _)| *joint).collect::<Vec<_>>(),
            },
            "remainder": self.rests,
            "not_examined": NOT_EXAMINED,
            "notes": self.setting.notes,
        })
    }
}

/// A number of a table; none where the closed loop without the structure is unstable.
fn cell(value: f64) -> String {
    if value.is_finite() { value.to_string() } else { String::new() }
}

const fn word(answer: Answer) -> &'static str {
    match answer {
        Answer::Needed => "needed",
        Answer::Missing => "missing",
        Answer::Wrong => "given_wrong",
        Answer::NotSupported => "not_supported",
    }
}

const fn short(objection: Objection) -> &'static str {
    match objection {
        Objection::Chance => "chance",
        Objection::Reduction => "reduction",
        Objection::Size => "size",
        Objection::Fit => "fit",
    }
}

/// Why a structure is not supported, in words.
fn reason(objection: Objection, c: &Comparison, demands: &Demands) -> String {
    match objection {
        Objection::Chance if c.gain_per_s <= 0.0 => "predictions are no better with it".into(),
        Objection::Chance => format!(
            "better on average over the {} of {} blocks in which it acts, and not beyond chance",
            c.blocks, c.all_blocks
        ),
        Objection::Reduction => {
            format!("it lowers the error of no joint by {:.0} %", 100.0 * demands.reduction)
        }
        Objection::Size => "its size is not two deviations from nothing".into(),
        Objection::Fit => "the fitted recordings are met no better with it than by chance".into(),
    }
}

/// A structure with its evidence, then its numbers, or why it is not supported.
fn line(f: &Finding, demands: &Demands, names: RobotNames<'_>, text: &mut String) {
    let c = &f.comparison;
    let [with, without] = c.rms_rad.map(|r| 1e3 * r);
    let own = if f.is_in_model || f.answer == Answer::Missing { "" } else { " (not in the model)" };
    let _ = writeln!(
        text,
        "  {:24} {with:8.2} {without:8.2} {:5.0} % {:8.2} ± {:<6.2} {:8.1e} {:>9}  {}{own}",
        f.structure.id,
        -100.0 * c.reduction,
        c.gain_per_s,
        c.deviation,
        c.probability,
        format!("{}/{}", c.blocks, c.all_blocks),
        f.structure.title
    );
    if let Some(objection) = f.objection {
        let _ = writeln!(text, "      {}", reason(objection, c, demands));
        return;
    }
    let shown = |structure: &Structure| {
        f.numbers.iter().filter(|n| is_beyond(structure, n, f.answer == Answer::Wrong)).collect::<Vec<_>>()
    };
    for n in shown(&f.structure) {
        let (name, value) = (of_joint(&n.name, names), with_deviation(n.value, n.deviation));
        let _ = writeln!(text, "      {name} {value} {}", n.unit);
    }
    if !f.alternatives.is_empty() {
        let _ = writeln!(
            text,
            "      or: {}; to tell, record {}",
            f.alternatives.join(", "),
            f.structure.decider
        );
    }
}
