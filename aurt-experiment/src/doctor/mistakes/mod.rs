//! The setup doctor: whether a robot's description and its recordings belong together, and which of the usual mistakes
//! would explain it if they do not.
//!
//! A trial undoes one mistake, calibrates rigid bodies with rotors, offsets of the measurement and plain friction on a
//! thinned part of the recordings and judges the fit on what is held out, where joints move. The error of a setup is the
//! root of the mean over joints of Σe²/Σy², of which a joint contributes 1 at most, and 1 where friction that feeds power
//! into the joint would be needed: a model with all signs turned fits as well, but cannot be.
//!
//! All mistakes are tried, in pairs too, if the setup as it is leaves more than 20 % at some joint that moves; otherwise the
//! likely ones, and the others if one of these would be told. A mistake is told by a test of the likelihood of what is held
//! out, of which the rate of false accusations is stated (`evidence`); undoing it must lower the error.

mod columns;
mod correction;
mod evidence;
mod explained;
mod folds;
mod found;
mod gravity;
mod mistake;
mod recordings;
mod search;
mod setup;
mod slips;
mod trial;
mod undoing;
mod usual;
mod variations;
mod wording;

use aurt_plugins::Registry;
use aurt_report::rendering::style::{Emphasis, Style};
use aurt_report::rendering::text::wrapped;
use aurt_traits::RobotNames;
use serde_json::{Value, json};

pub use self::columns::oddities;
pub use self::correction::corrected;
pub use self::explained::{Poor, loudly, poorly_explained};
pub use self::found::{Found, Step};
use self::gravity::GravitySign;
pub use self::mistake::{Columns, Mistake, Reading, Table};
use self::recordings::search_recordings;
use self::search::{Thorough, search};
use self::setup::{Extent, Setup};
pub use self::setup::{Subject, median_period_s, recordings_of};
use self::trial::Bench;
pub use self::trial::Score;
use crate::doctor::inspection::judged::{often_left_out, plain_friction};
use crate::workbench::experiments::friction;
use crate::workbench::failure::Failure;

/// Below this share a joint counts as hardly explained.
const HARDLY: f64 = 0.1;

/// The answer to the question which of the usual mistakes a setup has.
#[derive(Debug, Clone)]
pub struct Examination {
    /// Errors of the setup as it is written; nothing if it allows no fit.
    pub written: Option<Score>,
    /// The search in the same setup with rotors and offsets, which experiments often leave out and all trials have.
    pub found: Found,
    /// What stays hardly explained in recordings, where no calibrated model says so.
    poor: Vec<Poor>,
    compares_robots: bool,
    has_open_gravity: bool,
    /// Whether the experiment has terms beside friction.
    has_terms: bool,
    files: Vec<String>,
    joint_names: Vec<String>,
}

pub fn examine(subject: &Subject, registry: &Registry) -> Result<Examination, Failure> {
    examined(subject, registry, Thorough::AnyJoint, None)
}

/// As [`examine`] for a setup on which a model was calibrated, with what that hardly explains.
pub fn examine_calibrated(
    subject: &Subject,
    poor: &[Poor],
    registry: &Registry,
) -> Result<Examination, Failure> {
    let thorough = if poor.is_empty() { Thorough::AllJoints } else { Thorough::Always };
    examined(subject, registry, thorough, Some(poor))
}

fn examined(
    subject: &Subject,
    registry: &Registry,
    thorough: Thorough,
    calibrated: Option<&[Poor]>,
) -> Result<Examination, Failure> {
    let mut arm_terms = subject.arm_terms.clone();
    for term in often_left_out(registry)? {
        if arm_terms.iter().all(|there| there.name() != term.name()) {
            arm_terms.push(term);
        }
    }
    let bench = Bench {
        friction: plain_friction(registry)?,
        arm_terms,
        scopes: subject.scopes.clone(),
        loaded_friction: friction(registry, "absolute", "sign", &[1])?,
        presliding_friction: friction(registry, "constant", "maxwell_slip", &[1])?,
        compares: false,
        separate: false,
    };
    let [brief, whole] = [Setup::of(subject, Extent::Brief)?, Setup::of(subject, Extent::Beginnings)?];
    let mut found = search(subject, &bench, [&brief, &whole], thorough);
    let mut has_open_gravity = false;
    // What `run` calibrates is not compared with other robots, as other setups are not.
    let asks =
        found.steps.is_empty() && !subject.compares_robots() && !matches!(thorough, Thorough::AllJoints);
    if asks && subject.gravity_m_s2 != [0.0; 3] {
        match GravitySign::of(&bench, [&brief, &whole]) {
            Some(GravitySign::Refuted(step)) => {
                found.after = Some(step.after.clone());
                found.steps.push(*step);
            }
            Some(GravitySign::Open) => has_open_gravity = true,
            Some(GravitySign::Confirmed) | None => {}
        }
    }
    let poor = search_recordings(subject, &bench, &brief, &mut found, calibrated)?;
    let own = Bench { arm_terms: subject.arm_terms.clone(), ..bench };
    Ok(Examination {
        written: own.score(&own.modelled(&brief)),
        has_terms: !own.arm_terms.is_empty(),
        found,
        poor,
        compares_robots: subject.compares_robots(),
        has_open_gravity,
        files: subject.recordings.iter().map(|r| r.loaded.source.label.clone()).collect(),
        joint_names: subject.joint_names().to_vec(),
    })
}

impl Examination {
    pub fn names(&self) -> RobotNames<'_> {
        RobotNames::of_joints(&self.joint_names)
    }

    /// What was found, in sentences that say by how much it helps and what to change.
    pub fn sentences(&self) -> Vec<String> {
        let steps = self.found.steps.iter();
        let before = std::iter::once(self.found.before.as_ref()).chain(steps.clone().map(|s| Some(&s.after)));
        steps
            .zip(before)
            .map(|(step, before)| wording::sentence(step, before, &self.files, self.names()))
            .collect()
    }

    /// The joints that are hardly explained in recordings, as a sentence.
    pub fn unexplained(&self) -> Option<String> {
        let each: Vec<String> = self.poor.iter().map(|p| p.share(self.names())).collect();
        (!each.is_empty()).then(|| {
            format!(
                "Rigid bodies with plain friction, fitted to all recordings, explain {}.",
                each.join(", ")
            )
        })
    }

    /// What the recordings leave open of the setup, in sentences.
    pub fn remarks(&self) -> Vec<String> {
        let of_gravity = "these currents do not tell the sign of gravity: the other way round it explains them as well; state \
                          `torque_constants_nm_per_a`, record motions that accelerate more, or make sure that the base stands as \
                          `gravity_m_s2` says";
        self.has_open_gravity.then(|| of_gravity.to_owned()).into_iter().collect()
    }

    /// A line for people on how well robot and recordings fit.
    pub fn summary(&self) -> String {
        let Some(written) = &self.written else {
            return "this robot cannot be fitted to these recordings at all".into();
        };
        let terms = if self.has_terms { " and the terms of the experiment" } else { "" };
        let of_joint = |(joint, error): (usize, &Option<f64>)| {
            let error = error.map_or_else(|| "–".into(), wording::percent);
            if self.joint_names.is_empty() { error } else { format!("{} {error}", self.names().joint(joint)) }
        };
        let joints: Vec<String> = written.joints.iter().enumerate().map(of_joint).collect();
        format!(
            "held-out error of rigid bodies with plain friction{terms}, joint by joint: {} ({} setups tried)",
            joints.join(", "),
            self.found.trials
        )
    }

    pub fn to_text(&self, style: Style) -> String {
        let sentences = self.sentences();
        let emphasis = if self.is_serious() { Emphasis::Warning } else { Emphasis::Title };
        let mut text = format!("\n{}\n", style.emphasise(emphasis, "robot and recordings together"));
        text.push_str(&wrapped(&self.summary()));
        text.extend(sentences.iter().map(|s| wrapped(s)));
        text.extend(self.unexplained().iter().map(|s| wrapped(s)));
        if sentences.is_empty() && (self.poor.is_empty() || self.hardly().is_some()) {
            text.push_str(&wrapped(&self.hardly().unwrap_or_else(|| self.nothing().into())));
        }
        text.extend(self.remarks().iter().map(|remark| wrapped(remark)));
        text
    }

    pub fn to_json(&self) -> Value {
        let score = |s: &Score| json!({ "error": s.total, "joints": s.joints });
        json!({
            "written": self.written.as_ref().map(score),
            "before": self.found.before.as_ref().map(score),
            "after": self.found.after.as_ref().map(score),
            "trials": self.found.trials,
            "doubt": self.hardly(),
            "unexplained": self.unexplained(),
            "remarks": self.remarks(),
            "compared": self.found.compared.iter().map(|c| json!({
                "change": wording::undone(&c.mistake, self.names()),
                "across": c.across,
                "within": c.within,
                "errors": c.errors,
            })).collect::<Vec<_>>(),
            "mistakes": self.found.steps.iter().zip(self.sentences()).map(|(step, sentence)| json!({
                "sentence": sentence,
                "change": wording::undone(&step.mistake, self.names()),
                "error": step.after.total,
            })).collect::<Vec<_>>(),
        })
    }

    pub const fn nothing(&self) -> &'static str {
        if self.compares_robots {
            "no common mistake explains more"
        } else {
            "no common mistake explains much more; to detect wrong zeros and geometries, torque constants are needed"
        }
    }

    /// Whether it should be heeded whatever a calibrated model explains: a mistake was found, nothing can be fitted, or
    /// friction gives power.
    pub fn is_serious(&self) -> bool {
        let fed = self.found.after.as_ref().is_none_or(|s| s.fed.contains(&true));
        !self.found.steps.is_empty() || !self.poor.is_empty() || fed
    }

    /// What is said if joints are hardly explained and no mistake that was tried would explain them.
    pub fn hardly(&self) -> Option<String> {
        let Some(score) = &self.found.after else {
            return Some(
                "No common mistake explains it: check that geometry and recordings are of the same robot, and the \
                 stamps."
                    .into(),
            );
        };
        let poor: Vec<String> = score
            .of_moving()
            .map(|(j, e)| (j, (1.0 - e * e).max(0.0)))
            .filter(|(_, e)| *e < HARDLY)
            .map(|(j, e)| format!("{:.0} % of {}", 100.0 * e, self.names().joint(j)))
            .collect();
        let fed: Vec<usize> = (0..score.fed.len()).filter(|j| score.fed[*j]).collect();
        let mut said = Vec::new();
        if !poor.is_empty() {
            said.push(format!(
                "Rigid bodies with plain friction explain {}, and no common mistake explains more: check that geometry and \
                 recordings are of the same robot, and what is measured.",
                poor.join(", ")
            ));
        }
        if !fed.is_empty() {
            let what = match fed.len() {
                1 => "sign of its position and measurement",
                _ => "signs of their positions and measurements",
            };
            said.push(format!(
                "The friction that fits {} gives power instead of taking it: check the {what}.",
                self.names().joint_list(&fed)
            ));
        }
        (!said.is_empty()).then(|| said.join(" "))
    }
}
