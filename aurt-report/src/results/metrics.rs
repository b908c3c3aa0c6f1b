//! `metrics.json`, and the same numbers as tables on the terminal.

use aurt::{CalibratedModel, Outcome, RecordingResult};
use aurt_calibration::{Calibration, CalibrationOptions, Metrics, Rest, Validation};
use aurt_traits::{RobotModel, RobotNames};
use serde::Serialize;
use serde_json::{Value, json};

use super::shapes;
use crate::rendering::joints::with_names;
use crate::rendering::number::{percent, significant};
use crate::rendering::style::{Emphasis, Style};
use crate::rendering::table::Table;
use crate::rendering::text::wrapped;
use crate::reports::figures::file_name;

/// A calibration with its errors on every recording.
#[derive(Debug)]
pub struct Results<'a> {
    pub model: &'a RobotModel,
    pub calibration: &'a Calibration,
    pub notes: &'a [String],
    pub recordings: &'a [RecordingResult],
}

impl<'a> Results<'a> {
    pub fn of(outcome: &'a Outcome, notes: &'a [String]) -> Self {
        let CalibratedModel { model, calibration, .. } = &outcome.calibrated;
        Self { model, calibration, notes, recordings: &outcome.recordings }
    }
}

impl Results<'_> {
    pub fn names(&self) -> RobotNames<'_> {
        self.model.names()
    }

    pub fn to_json(&self) -> Value {
        let Calibration { options, .. } = self.calibration;
        let mut document = json!({
            "aurt_version": env!("CARGO_PKG_VERSION"),
            "base_parameters": self.model.base().len(),
            "parameters": self.model.parameters().len(),
            "condition_number": self.calibration.condition_number,
            "load_torque": options.load_torque,
            "estimator": options.estimator,
            "rest": options.rest,
            "rest_velocity_rad_s": options.rest_velocity_rad_s,
            "f_dyn_hz": self.calibration.f_dyn_hz,
            "sigma": self.calibration.sigma,
            "joint_names": self.model.rigid_body().joint_names(),
            "samples_per_joint": self.calibration.samples_per_joint,
            "warnings": self.calibration.warnings,
            "notes": self.notes,
            "recordings": self.recordings.iter().map(|r| self.recording_json(r)).collect::<Vec<_>>(),
        });
        if self.model.rigid_body().joint_names().is_empty()
            && let Some(entries) = document.as_object_mut()
        {
            entries.remove("joint_names");
        }
        let Calibration { shape_fit, consistent, essential, robust, position_bias, .. } = self.calibration;
        for (key, report) in [
            ("shape_fit", json!(shape_fit)),
            ("consistent", json!(consistent)),
            ("essential", json!(essential)),
            ("robust", json!(robust)),
            ("position_bias", json!(position_bias)),
        ] {
            if !report.is_null() {
                document[key] = report;
            }
        }
        with_names(document, self.model.rigid_body().joint_names())
    }

    fn recording_json(&self, recording: &RecordingResult) -> Value {
        let Validation { samples, all, moving, warnings, .. } = &recording.validation;
        let mut entries = json!({
            "file": recording.label,
            "role": recording.role.name(),
            "samples": samples,
            "unit": self.calibration.unit.symbol(),
            "mse": all.mse,
            "nmse": all.nmse,
            "nrmse": all.nrmse,
            "moving": {
                "samples": moving.samples, "mse": moving.mse, "nmse": moving.nmse, "nrmse": moving.nrmse,
            },
            "warnings": warnings,
            "notes": recording.notes,
            "prediction": recording.prediction,
        });
        if let Some(window) = recording.window_s {
            entries["window_s"] = json!(window);
        }
        entries
    }

    /// The same for a terminal of 80 columns.
    pub fn to_text(&self, style: Style) -> String {
        let Calibration { options, .. } = self.calibration;
        let mut text = format!(
            "{}\n  {} joints, {} parameters ({} base parameters), unit {}\n  \
             {} fit to {} rows per joint, τ_J {}, rest {}, f_dyn {} Hz\n  condition number {}\n",
            style.emphasise(Emphasis::Title, "calibration"),
            self.model.joints(),
            self.model.parameters().len(),
            self.model.base().len(),
            self.calibration.unit.symbol(),
            word(options.estimator).to_uppercase(),
            rows(&self.calibration.samples_per_joint),
            word(options.load_torque),
            match options.rest {
                Rest::Keep => "kept",
                Rest::Exclude => "excluded",
            },
            self.calibration.f_dyn_hz,
            significant(self.calibration.condition_number, 3),
        );
        let names = self.names();
        if !names.joints.is_empty() {
            // Coefficients carry numbers.
            text.push_str(&wrapped(&format!("joints, from 0: {}", names.joints.join(", "))));
        }
        for note in self.notes {
            text.push_str(&wrapped(&format!("note: {note}")));
        }
        let warning = style.emphasise(Emphasis::Warning, "warning");
        let warn = |text: &mut String, sentences: &[String]| {
            text.extend(sentences.iter().map(|s| wrapped(&format!("{warning}: {s}"))));
        };
        if let Some(report) = &self.calibration.shape_fit {
            text.push_str(&shapes::to_text(report, names));
        }
        if let Some(report) = &self.calibration.consistent {
            let open = report.standard.iter().filter(|s| !s.determined).count();
            let held = if report.prior {
                "are held by the description"
            } else {
                "are one choice of many that explain the data equally; masses of single links are not determined by torques: a \
                 description of the robot as `prior` holds them"
            };
            text.push_str(&wrapped(&format!(
                "consistent: χ² {} above least squares, {} coefficients determined; {open} of {} standard parameters {held} \
                 (metrics.json names them)",
                significant(report.loss, 3),
                report.determined,
                report.standard.len()
            )));
        }
        if let Some(report) = &self.calibration.essential {
            text.push_str(&super::essential::to_text(report));
        }
        if let Some(report) = &self.calibration.robust {
            text.push_str(&wrapped(&super::robust::sentence(report, names)));
        }
        if let Some(report) = &self.calibration.position_bias {
            text.push_str(&wrapped(&super::position_bias::sentence(report, names)));
        }
        warn(&mut text, &self.calibration.warnings);
        for recording in self.recordings {
            let window =
                recording.window_s.map_or(String::new(), |[from, to]| format!(", {from} s to {to} s"));
            let title = format!("{} ({}{window})", recording.label, recording.role.name());
            text.push_str(&format!("\n{}\n", style.emphasise(Emphasis::Title, &title)));
            text.push_str(&self.table(&recording.validation));
            warn(&mut text, &recording.validation.warnings);
        }
        let title = style.emphasise(Emphasis::Title, "what was done to the recordings");
        text.push_str(&format!("\n{title}\n"));
        for (note, labels) in self.notes_by_sentence() {
            let whose = if labels.len() == self.recordings.len() { "all".into() } else { labels.join(", ") };
            text.push_str(&wrapped(&format!("{whose}: {note}")));
        }
        text
    }

    /// The notes about recordings, each with the recordings that it is about.
    fn notes_by_sentence(&self) -> Vec<(&str, Vec<&str>)> {
        let mut notes: Vec<(&str, Vec<&str>)> = Vec::new();
        for recording in self.recordings {
            let label = file_name(&recording.label);
            for note in &recording.notes {
                match notes.iter_mut().find(|(known, _)| known == note) {
                    Some((_, labels)) => labels.push(label),
                    None => notes.push((note, vec![label])),
                }
            }
        }
        notes
    }

    pub(crate) fn error_headings(&self, joint: &str, rows: &str) -> [String; 8] {
        let unit = self.calibration.unit.symbol();
        let errors = || [format!("MSE {unit}²"), format!("NMSE {unit}"), "NRMS %".into()];
        let ([a, b, c], [d, e, f]) = (errors(), errors());
        [joint.to_owned(), a, b, c, rows.to_owned(), d, e, f]
    }

    /// One row per joint: errors over all rows and over those at which the joint moves.
    pub(crate) fn error_cells<'v>(
        &'v self,
        validation: &'v Validation,
    ) -> impl Iterator<Item = [String; 8]> + 'v {
        (0..validation.all.mse.len()).map(|joint| {
            let errors = |m: &Metrics| {
                [significant(m.mse[joint], 4), significant(m.nmse[joint], 4), percent(m.nrmse[joint])]
            };
            let ([a, b, c], [d, e, f]) = (errors(&validation.all), errors(&validation.moving));
            let rows = validation.moving.samples[joint].to_string();
            [self.names().joint_cell(joint), a, b, c, rows, d, e, f]
        })
    }

    pub fn rest_velocity(&self) -> String {
        rest_velocity(self.model, &self.calibration.options)
    }

    fn table(&self, validation: &Validation) -> String {
        let mut table = Table::new(self.error_headings("joint", "rows"))
            .group(1, "")
            .group(3, format!("all {} rows", validation.samples))
            .group(4, format!("moving, |q̇| > {}", self.rest_velocity()))
            .left(usize::from(!self.names().joints.is_empty()));
        self.error_cells(validation).for_each(|cells| table.row(cells));
        table.render()
    }
}

/// The |q̇| up to which the joints of a model rest, in words.
pub fn rest_velocity(model: &RobotModel, options: &CalibrationOptions) -> String {
    let bodies = model.rigid_body();
    let mut sliding = (0..model.joints()).filter(|joint| bodies.slides(*joint));
    let turns = options.rest_velocity_rad_s;
    match sliding.next() {
        Some(joint) => format!("{turns} rad/s or {} m/s", options.rest_velocity(&**bodies, joint)),
        None => format!("{turns} rad/s"),
    }
}

fn rows(samples_per_joint: &[usize]) -> String {
    match (samples_per_joint.iter().min(), samples_per_joint.iter().max()) {
        (Some(least), Some(most)) if least != most => format!("{least} to {most}"),
        (Some(least), _) => least.to_string(),
        _ => "0".into(),
    }
}

/// A choice as experiments write it.
fn word(choice: impl Serialize) -> String {
    json!(choice).as_str().unwrap_or_default().to_owned()
}
