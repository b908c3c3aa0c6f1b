//! `aurt check`: what a recording is good for, before anyone calibrates on it.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use aurt::{
    Role,
    data::{Instrument, Loaded, Pipeline, Preprocessing, Purpose, Source},
    fitting::Assigned,
};
use aurt_doctor::{
    doctor::{self, Subject},
    inspection::{
        inspected::{Inspected, rest},
        joints::suitable_f_dyn_hz,
        judged::{Judged, plain_friction},
    },
    report::Checked,
};
use aurt_experiment::Experiment;
use aurt_model::{BASE_PARAMETER_SEED, RigidBodyDynamics};
use aurt_rbd::{MdhTable, RobotDescription};
use aurt_recording::RobotJoints;
use aurt_report::{rendering::text::wrapped, reports};
use aurt_traits::{MeasurementUnit, RigidBodyRegressor};
use aurt_workbench::{
    experiments::source,
    failure::Failure,
    output::{OutputFolder, Outputs},
};
use clap::Args;
use serde_json::{Value, json};

use super::{
    Session,
    checked_setup::{self, checked},
    compile_rbd::Rows,
    data_options::ReadingOptions,
    plots::PlotOptions,
    run::{drawn_text, written_text},
};
use crate::{
    rendering::terminal::{Emphasis, Report, Terminal},
    values::{Gravity, parse_gravity, parse_positive},
};

/// f_dyn unless asked for otherwise, and the share of the sampling rate that it must stay below.
const DEFAULT_F_DYN_HZ: f64 = 10.0;
const F_DYN_SHARE_OF_RATE: f64 = 0.05;

/// Check recordings before calibrating on them.
///
/// Reports sampling, range and sensor quality of each joint and, with the robot's geometry, which
/// parameters the motions determine, for each recording and for all together. Tries common mistakes of the
/// setup (units, signs, orders, gravity, tables, delays) against the data and reports the fix that explains
/// them. Exit status 1 if there are findings.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  aurt check recording.csv\n  \
    aurt check experiment.toml --fixed corrected.toml\n  \
    aurt check recording.csv --mdh mdh.csv --gravity 0 0 -9.81 --out check\n  \
    aurt check monday.csv tuesday.csv --mdh mdh.csv")]
pub struct Check {
    /// Recordings to be calibrated on together, or one experiment (.toml)
    #[arg(value_name = "RECORDING|EXPERIMENT.toml", required = true)]
    recordings: Vec<PathBuf>,
    /// Table of modified Denavit–Hartenberg parameters; with it the check reports which parameters the
    /// motion determines
    #[arg(long, value_name = "MDH.csv")]
    mdh: Option<PathBuf>,
    /// Which joint a row's alpha and a lead to
    #[arg(long, value_enum, default_value_t, requires = "mdh")]
    mdh_rows: Rows,
    /// Gravitational acceleration in the base frame, m/s²
    #[arg(
        long, value_name = "X Y Z", value_parser = parse_gravity, allow_hyphen_values = true,
        default_value = "0 0 -9.81", requires = "mdh"
    )]
    gravity: Gravity,
    /// Highest frequency of the robot's dynamics; by default 10, less for slow recordings
    #[arg(long, value_name = "HZ", value_parser = parse_positive)]
    f_dyn_hz: Option<f64>,
    /// File for the corrected experiment, in the folder of the experiment; written if mistakes were found
    #[arg(long, value_name = "OUT.toml")]
    fixed: Option<PathBuf>,
    /// Folder for report.html, one folder for each of several recordings; created if it does not exist
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    plots: PlotOptions,
    #[command(flatten)]
    reading: ReadingOptions,
}

impl Check {
    /// Checks.
    pub fn run(&self, session: &mut Session<'_>) -> Result<Report, Failure> {
        let folder = self.out.as_deref().map(|out| OutputFolder::new("--out", out)).transpose()?;
        let plots = self.plots.folder()?;
        let experiment = match self.recordings.as_slice() {
            [one] if one.extension().is_some_and(|e| e == "toml") => {
                Some(Experiment::read(one, &mut session.registry)?)
            }
            _ => None,
        };
        let fixed = checked_setup::place(self.fixed.as_deref(), experiment.as_ref())?;
        let table = self.mdh.as_ref().map(|p| MdhTable::from_path(p, self.mdh_rows.into())).transpose()?;
        let rigid_body = match (&experiment, &table) {
            (Some(e), _) => Some(e.robot.rigid_body().map_err(Failure::from)?),
            (None, Some(table)) => Some(table.rigid_body(self.gravity.0)?),
            (None, None) => None,
        };
        let mut joints = rigid_body.as_ref().map(|body| RobotJoints::of(&**body));
        let mut assigned = Vec::new();
        for (source, role) in self.sources(experiment.as_ref()) {
            let loaded = Loaded::read(source, joints.as_ref(), Purpose::Prediction)?;
            joints = joints.or_else(|| Some(loaded.recording.robot_joints()));
            assigned.push(Assigned { loaded, role });
        }
        let of_experiment = experiment.as_ref().map(|e| e.preprocess.f_dyn_hz);
        let f_dyn_hz = self.f_dyn_hz.or(of_experiment).unwrap_or_else(|| highest_f_dyn_hz(&assigned));
        let preprocessing = preprocessing(f_dyn_hz);
        let pipeline = Pipeline {
            joints: joints.unwrap_or_default(),
            preprocessing: &preprocessing,
            instrument: &Instrument::default(),
        };
        let unit = pipeline.common_unit(assigned.iter().map(|a| &a.loaded))?;
        let subject = match (&experiment, &table) {
            (Some(e), _) => Some(Subject::of_experiment(e, assigned.clone())?),
            (None, Some(t)) => Some(Subject::of_table(t, self.gravity.0, assigned.clone(), f_dyn_hz)),
            (None, None) => None,
        };
        let roles: Vec<Role> = assigned.iter().map(|a| a.role).collect();
        let inspected: Vec<Inspected> = assigned
            .into_iter()
            .map(|a| Inspected::new(a.loaded, &preprocessing))
            .collect::<Result<_, _>>()?;

        let excitation = Excitation { session, rigid_body, unit, preprocessing: &preprocessing };
        let alone: Vec<Seen<'_>> = inspected
            .iter()
            .map(|one| Ok(Seen { one, judged: excitation.of(&[one])? }))
            .collect::<Result<_, Failure>>()?;
        let mut report = match alone.as_slice() {
            [only] => only.report(session.terminal),
            several => {
                let fitted = inspected.iter().zip(&roles).filter(|(_, r)| **r == Role::Calibration);
                let all: Vec<&Inspected> = fitted.map(|(one, _)| one).collect();
                let judged = excitation.of(&all)?;
                together(several, judged.as_ref(), session.terminal)
            }
        };
        if let Some(subject) = subject {
            let (registry, terminal) = (&session.registry, session.terminal);
            checked(&subject, experiment.as_ref(), fixed.as_ref(), registry, terminal, &mut report)?;
        }
        self.draw(&alone, &mut report, folder.as_ref(), plots.as_ref())?;
        Ok(report)
    }

    /// What is to be checked, and what it is for.
    fn sources(&self, experiment: Option<&Experiment>) -> Vec<(Source, Role)> {
        let Some(experiment) = experiment else {
            return self.recordings.iter().map(|f| (self.reading.source(f), Role::Calibration)).collect();
        };
        let recordings = &experiment.recordings;
        let calibration = recordings.calibration.iter().map(|r| (source(r), Role::Calibration));
        calibration.chain(recordings.validation.iter().map(|r| (source(r), Role::Validation))).collect()
    }

    /// Pages and figures; of several recordings each in a folder of its own.
    fn draw(
        &self,
        alone: &[Seen<'_>],
        report: &mut Report,
        folder: Option<&OutputFolder>,
        plots: Option<&OutputFolder>,
    ) -> Result<(), Failure> {
        if folder.is_none() && plots.is_none() {
            return Ok(());
        }
        let mut taken: Vec<String> = Vec::new();
        let (mut pages, mut figures) = (Vec::new(), Vec::new());
        let mut outputs = Outputs::default();
        for seen in alone {
            let part = |of: Option<&OutputFolder>, option| -> Result<Option<OutputFolder>, Failure> {
                match of {
                    Some(whole) if alone.len() > 1 => {
                        OutputFolder::nested(option, &whole.path().join(own_name(seen.one, &taken))).map(Some)
                    }
                    whole => Ok(whole.cloned()),
                }
            };
            let (folder, plots) = (part(folder, "--out")?, part(plots, "--plots")?);
            taken.push(own_name(seen.one, &taken));
            let page = seen.page();
            if let Some(folder) = &folder {
                outputs.folder(folder, [(reports::FILE.to_owned(), page.to_html().into_bytes())]);
                pages.push(folder.path().join(reports::FILE));
            }
            figures.extend(outputs.figures(&page, plots.as_ref()));
        }
        outputs.write()?;
        report.text.push_str(&written_text(&pages));
        report.text.push_str(&drawn_text(&figures, plots));
        pages.extend(figures);
        report.json["outputs"] = json!(pages);
        Ok(())
    }
}

/// What recordings excite, where the geometry is known.
struct Excitation<'a> {
    session: &'a Session<'a>,
    rigid_body: Option<Arc<dyn RigidBodyRegressor>>,
    unit: Option<MeasurementUnit>,
    preprocessing: &'a Preprocessing,
}

impl Excitation<'_> {
    /// Which parameters of rigid bodies, Coulomb and viscous friction the motions determine.
    fn of(&self, recordings: &[&Inspected]) -> Result<Option<Judged>, Failure> {
        let Some(rigid_body) = &self.rigid_body else { return Ok(None) };
        let dynamics = RigidBodyDynamics::new(rigid_body.clone(), BASE_PARAMETER_SEED)?;
        let stacks = vec![plain_friction(&self.session.registry)?; rigid_body.joints()];
        let model = dynamics.with_joint_dynamics(stacks, Vec::new())?;
        let still = recordings.iter().map(|r| r.still(self.preprocessing)).collect::<Result<Vec<_>, _>>()?;
        let measured = recordings.iter().all(|r| r.loaded.recording.measurement.is_some());
        Judged::new(model, &still, self.unit.filter(|_| measured), self.preprocessing.f_dyn_hz).map(Some)
    }
}

/// A recording with what its motion excites by itself.
struct Seen<'a> {
    one: &'a Inspected,
    judged: Option<Judged>,
}

impl Seen<'_> {
    /// What should be heeded if it is calibrated on alone.
    fn findings(&self) -> Vec<String> {
        let mut findings = self.one.faults();
        findings.extend(rest(&self.one.joints.iter().map(|j| j.moves()).collect::<Vec<_>>()));
        findings.extend(self.judged.iter().flat_map(Judged::findings));
        findings
    }

    fn report(&self, terminal: &Terminal) -> Report {
        let findings = self.findings();
        let mut text = self.one.to_text(self.judged.as_ref(), terminal.style());
        text.push_str(&suitable(self.one.suitable_f_dyn_hz()));
        let measured = self.one.loaded.recording.measurement.is_some();
        text.push_str(&heeded(&findings, "it", measured, terminal));
        let mut json = self.one.to_json(self.judged.as_ref(), &findings);
        json["command"] = json!("check");
        Report { text, findings: !findings.is_empty(), json }
    }

    fn page(&self) -> aurt_report::Page {
        let findings = self.findings();
        Checked {
            name: self.one.label(),
            recording: &self.one.loaded.recording,
            prepared: &self.one.prepared,
            joints: &self.one.joints,
            excited: self.judged.as_ref().map(Judged::named),
            findings: &findings,
            notes: &self.one.notes(),
            suitable_f_dyn_hz: self.one.suitable_f_dyn_hz(),
            document: &self.one.to_json(self.judged.as_ref(), &findings),
        }
        .page()
    }
}

/// Several recordings: each by itself, and what a calibration on all of them would have to heed.
fn together(several: &[Seen<'_>], judged: Option<&Judged>, terminal: &Terminal) -> Report {
    let mut text = String::new();
    for seen in several {
        text.push_str(&seen.one.to_text(seen.judged.as_ref(), terminal.style()));
        text.push('\n');
    }
    let joints = several.first().map_or(0, |s| s.one.joints.len());
    let moves: Vec<bool> =
        (0..joints).map(|j| several.iter().any(|s| s.one.joints.get(j).is_some_and(|r| r.moves()))).collect();
    let mut findings: Vec<String> = several.iter().flat_map(|s| s.one.faults()).collect();
    findings.extend(rest(&moves));
    findings.extend(judged.iter().flat_map(|j| j.findings()));
    // The fastest motion and the slowest clock decide.
    let slowest_hz = several.iter().map(|s| s.one.prepared.report.rate_hz).fold(f64::INFINITY, f64::min);
    let f_dyn_hz = suitable_f_dyn_hz(several.iter().flat_map(|s| &s.one.joints), slowest_hz);

    let title = terminal.emphasise(Emphasis::Title, &format!("all {} together", several.len()));
    text.push_str(&format!("{title}\n"));
    if let Some(judged) = judged {
        text.push_str(&judged.to_text());
    }
    text.push_str(&suitable(f_dyn_hz));
    let measured = several.iter().all(|s| s.one.loaded.recording.measurement.is_some());
    text.push_str(&heeded(&findings, "them together", measured, terminal));
    let recordings: Vec<Value> =
        several.iter().map(|s| s.one.to_json(s.judged.as_ref(), &s.findings())).collect();
    let json = json!({
        "command": "check",
        "recordings": recordings,
        "together": {
            "suitable_f_dyn_hz": f_dyn_hz,
            "excitation": judged.map(Judged::to_json),
        },
        "suitable_f_dyn_hz": f_dyn_hz,
        "findings": findings,
    });
    Report { text, findings: !findings.is_empty(), json }
}

fn suitable(f_dyn_hz: Option<f64>) -> String {
    f_dyn_hz.map_or_else(String::new, |f| {
        wrapped(&format!("for an experiment on such motions: f_dyn_hz = {f} under [preprocess]"))
    })
}

fn heeded(findings: &[String], what: &str, measured: bool, terminal: &Terminal) -> String {
    if findings.is_empty() {
        let title = terminal.emphasise(Emphasis::Title, "findings");
        let said = if measured {
            format!("ready to calibrate on {what}")
        } else {
            format!("ready to predict for {what}; calibration needs measured currents or torques")
        };
        return format!("\n{title}\n{}", wrapped(&said));
    }
    let heading = terminal.emphasise(Emphasis::Warning, "findings");
    let lines: String = findings.iter().map(|f| wrapped(f)).collect();
    format!("\n{heading}\n{lines}")
}

/// A name for a recording's own folder that no other has.
fn own_name(one: &Inspected, taken: &[String]) -> String {
    let stem = Path::new(one.label()).file_stem().map_or_else(|| "recording".into(), |s| s.to_string_lossy());
    let names = (1..).map(|k| if k == 1 { stem.to_string() } else { format!("{stem}_{k}") });
    names.into_iter().find(|n| !taken.contains(n)).unwrap_or_default()
}

fn preprocessing(f_dyn_hz: f64) -> Preprocessing {
    Preprocessing { trim_rest: false, ..Preprocessing::new(f_dyn_hz) }
}

/// The f_dyn to look with: what is usual, less where the slowest recording asks for it.
fn highest_f_dyn_hz(assigned: &[Assigned]) -> f64 {
    let rate_hz = |a: &Assigned| 1.0 / doctor::median_period_s(&a.loaded.recording.time_s);
    let slowest_hz = assigned.iter().map(rate_hz).fold(f64::INFINITY, f64::min);
    (DEFAULT_F_DYN_HZ.min(F_DYN_SHARE_OF_RATE * slowest_hz) * 1e3).round() / 1e3
}
