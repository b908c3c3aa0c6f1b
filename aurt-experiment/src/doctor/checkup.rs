//! What recordings are good for, before anyone calibrates on them, and which usual mistakes of the setup they show.

use std::path::Path;
use std::sync::Arc;

use crate::Experiment;
use crate::experiment::Recordings;
use crate::workbench::failure::Failure;
use aurt::Role;
use aurt::data::{Instrument, Loaded, Pipeline, Preprocessing, Purpose, Source};
use aurt::duplicates::SampleRegister;
use aurt::fitting::Assigned;
use aurt_plugins::Registry;
use aurt_plugins::model::{BASE_PARAMETER_SEED, RigidBodyDynamics};
use aurt_rbd::{MdhTable, RobotDescription};
use aurt_recording::{Recording, RobotJoints};
use aurt_report::Page;
use aurt_report::rendering::style::{Emphasis, Style};
use aurt_report::rendering::text::wrapped;
use aurt_traits::{MeasurementUnit, RigidBodyRegressor, RobotNames};
use serde_json::{Value, json};

use crate::doctor::inspection::inspected::{Inspected, Reading, rest};
use crate::doctor::inspection::judged::{Judged, plain_friction};
use crate::doctor::mistakes::{self, Examination, Subject};

#[derive(Debug, Clone, Copy)]
pub enum Known<'a> {
    Nothing,
    /// A table, and the gravitational acceleration in its base frame, m/s².
    Table(&'a MdhTable, [f64; 3]),
    Bodies(&'a Arc<dyn RigidBodyRegressor>),
    Experiment(&'a Experiment),
}

#[derive(Debug, Clone)]
pub enum Given {
    File(Box<Source>),
    Recording(Arc<Recording>),
}

#[derive(Debug)]
pub struct Question<'a> {
    pub robot: Known<'a>,
    /// Recordings to be calibrated on together; those of an experiment are checked beside them.
    pub recordings: Vec<Given>,
    /// Highest frequency of the robot's dynamics, Hz, if it is asked for.
    pub f_dyn_hz: Option<f64>,
    pub registry: &'a Registry,
}

pub struct Checkup {
    /// Each recording with what its motion excites by itself.
    alone: Vec<Inspected>,
    /// What all that is fitted excites together, where there are several.
    together: Option<Judged>,
    /// The setup, where the robot is known.
    pub subject: Option<Subject>,
    /// Which usual mistakes it shows, where something was measured.
    pub examination: Option<Examination>,
}

/// Checks recordings, and the setup if the robot is known.
pub fn check(question: Question<'_>) -> Result<Checkup, Failure> {
    let Question { robot, recordings, f_dyn_hz, registry } = question;
    let rigid_body = match robot {
        Known::Nothing => None,
        Known::Table(table, gravity_m_s2) => Some(table.rigid_body(gravity_m_s2)?),
        Known::Bodies(bodies) => Some(bodies.clone()),
        Known::Experiment(experiment) => Some(experiment.robot.rigid_body().map_err(Failure::from)?),
    };
    let mut joints = rigid_body.as_ref().map(|body| RobotJoints::of(&**body));
    let (mut assigned, mut stamps) = (Vec::new(), Vec::new());
    for (given, role) in sources(robot).chain(recordings.into_iter().map(|r| (r, Role::Calibration))) {
        let reading = match given {
            Given::File(source) => {
                Reading::of(*source, |source| Loaded::read(source, joints.as_ref(), Purpose::Prediction))?
            }
            Given::Recording(recording) => {
                let own =
                    || RobotJoints { names: recording.joints.names().to_vec(), ..recording.joints().into() };
                // Arrays are in s: whoever made them knows.
                Reading { loaded: Loaded::of(&recording, &joints.clone().unwrap_or_else(own))?, stamps: None }
            }
        };
        joints = joints.or_else(|| Some(reading.loaded.recording.robot_joints()));
        assigned.push(Assigned { loaded: reading.loaded, role });
        stamps.push(reading.stamps);
    }
    SampleRegister::check(assigned.iter().map(|a| (&a.loaded, a.role.name())))?;
    let of_experiment = match robot {
        Known::Experiment(experiment) => Some(experiment.preprocess.f_dyn_hz),
        _ => None,
    };
    let rate_hz = |a: &Assigned| 1.0 / mistakes::median_period_s(&a.loaded.recording.time_s);
    let first_look = Preprocessing::first_look(assigned.iter().map(rate_hz).fold(f64::INFINITY, f64::min));
    let f_dyn_hz = f_dyn_hz.or(of_experiment).unwrap_or(first_look.f_dyn_hz);
    let preprocessing = Preprocessing { f_dyn_hz, ..first_look };
    let pipeline = Pipeline {
        joints: joints.unwrap_or_default(),
        preprocessing: &preprocessing,
        instrument: &Instrument::default(),
    };
    let unit = pipeline.common_unit(assigned.iter().map(|a| &a.loaded))?;
    let subject = match robot {
        Known::Nothing => None,
        Known::Table(table, gravity_m_s2) => {
            Some(Subject::of_table(table, gravity_m_s2, assigned.clone(), f_dyn_hz))
        }
        Known::Bodies(bodies) => Subject::of_bodies(&**bodies, assigned.clone(), f_dyn_hz),
        Known::Experiment(experiment) => Some(Subject::of_experiment(experiment, assigned.clone())?),
    };
    let roles: Vec<Role> = assigned.iter().map(|a| a.role).collect();
    let readings = assigned.into_iter().zip(stamps);
    let inspected: Vec<Inspected> = readings
        .map(|(a, stamps)| Inspected::new(Reading { loaded: a.loaded, stamps }, &preprocessing))
        .collect::<Result<_, _>>()?;
    let excitation = Excitation { registry, rigid_body, unit, preprocessing: &preprocessing };
    let together = if inspected.len() > 1 {
        let fitted = inspected.iter().zip(&roles).filter(|(_, r)| **r == Role::Calibration);
        excitation.of(&fitted.map(|(one, _)| one).collect::<Vec<_>>())?
    } else {
        None
    };
    let alone = inspected
        .into_iter()
        .map(|one| Ok(Inspected { judged: excitation.of(&[&one])?, ..one }))
        .collect::<Result<_, Failure>>()?;
    let measured = |s: &&Subject| s.recordings.iter().any(|r| r.loaded.recording.measurement.is_some());
    let examination =
        subject.as_ref().filter(measured).map(|s| mistakes::examine(s, registry)).transpose()?;
    Ok(Checkup { alone, together, subject, examination })
}

/// What an experiment is about to use, and what for.
fn sources(robot: Known<'_>) -> impl Iterator<Item = (Given, Role)> {
    let recordings = match robot {
        Known::Experiment(experiment) => Some(&experiment.recordings),
        _ => None,
    };
    let sources = recordings.into_iter().flat_map(Recordings::fitted_and_held_out);
    sources.map(|(source, role)| (Given::File(Box::new(source.clone())), role))
}

impl Checkup {
    pub fn has_findings(&self) -> bool {
        let setup = self.examination.as_ref();
        !self.of_recordings().is_empty() || setup.is_some_and(|e| e.is_serious() || e.hardly().is_some())
    }

    /// Whether stamps were read in another unit than the experiment says.
    pub fn has_other_stamps(&self) -> bool {
        self.alone.iter().any(|one| one.stamps.is_some())
    }

    pub fn findings(&self) -> Vec<String> {
        let mut findings = self.of_recordings();
        findings.extend(self.examination.iter().flat_map(Examination::sentences));
        findings.extend(self.examination.iter().filter_map(Examination::unexplained));
        findings
    }

    fn of_recordings(&self) -> Vec<String> {
        let several = match self.alone.as_slice() {
            [only] => return only.findings(),
            several => several,
        };
        let joints = several.first().map_or(0, |one| one.joints.len());
        let moves: Vec<bool> = (0..joints)
            .map(|j| several.iter().any(|one| one.joints.get(j).is_some_and(|r| r.moves())))
            .collect();
        let mut findings: Vec<String> = several.iter().flat_map(Inspected::faults).collect();
        let names = several.first().map_or_else(RobotNames::default, Inspected::names);
        findings.extend(rest(&moves, names));
        findings.extend(self.together.iter().flat_map(Judged::findings));
        findings
    }

    pub fn suitable_f_dyn_hz(&self) -> Option<f64> {
        aurt_recording::suitable_f_dyn_hz(self.alone.iter().map(|one| &one.prepared))
    }

    pub fn to_text(&self, style: Style) -> String {
        let (mut text, several) = (String::new(), self.alone.len() > 1);
        for one in &self.alone {
            text.push_str(&one.to_text(style));
            if several {
                text.push('\n');
            }
        }
        if several {
            let title = style.emphasise(Emphasis::Title, &format!("all {} together", self.alone.len()));
            text.push_str(&format!("{title}\n"));
            text.extend(self.together.iter().map(Judged::to_text));
        }
        text.extend(self.suitable_f_dyn_hz().map(|f| {
            wrapped(&format!("for an experiment on such motions: f_dyn_hz = {f} under [preprocess]"))
        }));
        text.push_str(&self.heeded(if several { "them together" } else { "it" }, style));
        text.extend(self.examination.iter().map(|examination| examination.to_text(style)));
        text
    }

    fn heeded(&self, what: &str, style: Style) -> String {
        let findings = self.of_recordings();
        if findings.is_empty() {
            let title = style.emphasise(Emphasis::Title, "findings");
            let measured = self.alone.iter().all(|one| one.loaded.recording.measurement.is_some());
            let is_doubted =
                self.examination.as_ref().is_some_and(|e| e.is_serious() || e.hardly().is_some());
            let said = if is_doubted {
                "none in columns and motions, but see robot and recordings together".to_owned()
            } else if measured {
                format!("ready to calibrate on {what}")
            } else {
                format!("ready to predict for {what}; calibration needs measured currents or torques")
            };
            return format!("\n{title}\n{}", wrapped(&said));
        }
        let heading = style.emphasise(Emphasis::Warning, "findings");
        let lines: String = findings.iter().map(|f| wrapped(f)).collect();
        format!("\n{heading}\n{lines}")
    }

    pub fn to_json(&self) -> Value {
        let mut json = if let [only] = self.alone.as_slice() {
            only.to_json()
        } else {
            let f_dyn_hz = self.suitable_f_dyn_hz();
            json!({
                "recordings": self.alone.iter().map(Inspected::to_json).collect::<Vec<_>>(),
                "together": {
                    "suitable_f_dyn_hz": f_dyn_hz,
                    "excitation": self.together.as_ref().map(Judged::to_json),
                },
                "suitable_f_dyn_hz": f_dyn_hz,
            })
        };
        json["findings"] = json!(self.findings());
        if let Some(examination) = &self.examination {
            json["setup"] = examination.to_json();
        }
        json
    }

    /// A page for each recording, with a name that no other has.
    pub fn pages(&self) -> Vec<(String, Page)> {
        let mut taken: Vec<String> = Vec::new();
        for one in &self.alone {
            taken.push(own_name(one, &taken));
        }
        taken.into_iter().zip(self.alone.iter().map(Inspected::page)).collect()
    }
}

/// What recordings excite, where the geometry is known.
struct Excitation<'a> {
    registry: &'a Registry,
    rigid_body: Option<Arc<dyn RigidBodyRegressor>>,
    unit: Option<MeasurementUnit>,
    preprocessing: &'a Preprocessing,
}

impl Excitation<'_> {
    /// Which parameters of rigid bodies, Coulomb and viscous friction the motions determine.
    fn of(&self, recordings: &[&Inspected]) -> Result<Option<Judged>, Failure> {
        let Some(rigid_body) = &self.rigid_body else { return Ok(None) };
        let dynamics = RigidBodyDynamics::new(rigid_body.clone(), BASE_PARAMETER_SEED)?;
        let stacks = vec![plain_friction(self.registry)?; rigid_body.joints()];
        let model = dynamics.with_joint_dynamics(stacks, Vec::new())?;
        let still = recordings.iter().map(|r| r.still(self.preprocessing)).collect::<Result<Vec<_>, _>>()?;
        let measured = recordings.iter().all(|r| r.loaded.recording.measurement.is_some());
        Judged::new(model, &still, self.unit.filter(|_| measured), self.preprocessing.f_dyn_hz).map(Some)
    }
}

/// A name for a recording's own folder that no other has.
fn own_name(one: &Inspected, taken: &[String]) -> String {
    let stem = Path::new(one.label()).file_stem().map_or_else(|| "recording".into(), |s| s.to_string_lossy());
    let names = (1..).map(|k| if k == 1 { stem.to_string() } else { format!("{stem}_{k}") });
    names.into_iter().find(|n| !taken.contains(n)).unwrap_or_default()
}
