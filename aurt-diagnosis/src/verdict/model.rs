use aurt_traits::{MeasurementUnit, RobotNames, Slot};
use serde::{Deserialize, Serialize};

use crate::investigation::WORSE;
use crate::parameters::Parameters;
use crate::remainder::{Remainder, Share};
use crate::request::SelectionOptions;
use crate::search::selection::Chosen;
use crate::transmission::VisibleGear;
use crate::vocabulary::{Effect, Family};

/// The answer in one word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Answer {
    /// The residual is noise.
    NoMismatch,
    /// The claims account for what is missing.
    Named,
    /// The claims hold, and something beside them is missing.
    PartlyExplained,
    /// Something is missing, and no known effect accounts for it.
    Unexplained,
    /// Nothing is missing in the fitted recordings, and the held-out ones are another state of the robot:
    /// [`Verdict::held_out_differs`].
    HeldOutDiffers,
}

/// Version of the keys of `verdict.json`: 2 has `partly_explained`, `explained` and `remainder`; `ambiguous` is no verdict any
/// more but a property of a claim that has `alternatives`.
pub const SCHEMA: u32 = 2;

/// A diagnosis, as `verdict.json` carries it. Joints count from 0.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// Version of this file's keys: [`SCHEMA`].
    #[serde(default)]
    pub schema: u32,
    /// Unit of the measurement. In A, parameters called `_nm` are in A, and those called `_kg` in A/Nm kg.
    #[serde(default)]
    pub unit: MeasurementUnit,
    /// Names of the joints, base first; empty where they have none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub joint_names: Vec<String>,
    /// Names of the links, that of the first joint first; empty where they have none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub link_names: Vec<String>,
    /// What an effect had to bring.
    #[serde(default)]
    pub settings: SelectionOptions,
    /// The answer: where there are targets beside other recordings, of what has changed in them; else of what is missing.
    pub verdict: Answer,
    /// Of what is missing in all recordings, where [`Self::verdict`] is about what has changed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub structure: Option<Answer>,
    /// The effects, strongest first. Each has passed every test and belongs to the answer of the recordings in which it is
    /// present.
    pub effects: Vec<Finding>,
    /// What describes these recordings and fails a test: it is not claimed. The improved model has it only if its one failed test
    /// is that the calibration recordings do not show it, or that they differ by as much.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub indications: Vec<Indication>,
    /// Registered friction models that predict what no named effect does, strongest first. They have no word of the
    /// vocabulary: where they alone explain the mismatch, the answer is `unexplained`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub registered_models: Vec<RegisteredFinding>,
    /// Effects that these recordings can neither show nor exclude.
    pub not_decidable: Vec<NotDecidable>,
    /// The gears that would have shown in these recordings, joint by joint, where gears were examined.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub gears_visible: Vec<VisibleGear>,
    /// What could not be looked at in these recordings, and why.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub not_examined: Vec<NotExamined>,
    /// What is left, joint by joint.
    pub residual: Vec<JointResidual>,
    /// Improvement on held-out data.
    pub held_out: HeldOut,
    /// Joints whose held-out error exceeds what the model's error on the fitted recordings lets expect.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub held_out_differs: Vec<HeldOutDifference>,
    /// Share of the held-out squared error of all joints beyond noise that the claims explain; absent without claims.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub explained: Option<Share>,
    /// How the held-out error is made up, joint by joint.
    #[serde(default)]
    pub remainder: Vec<Remainder>,
    /// How much the rest of the model moved when the effects were added: parameter, before, after, and the
    /// shift in standard deviations.
    pub shifts: Vec<Shift>,
    /// What speaks against it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// What a reader should know of how this was found.
    pub notes: Vec<String>,
}

impl Verdict {
    /// Names of the robot's joints and links.
    pub fn names(&self) -> RobotNames<'_> {
        RobotNames { joints: &self.joint_names, links: &self.link_names }
    }

    /// Indications of a change in the targets that chance does not explain: `p_null` is within the level, and another test fails. Those
    /// that are within what recordings of an unchanged robot differ by, or those that are not.
    pub fn indicated_changes(&self, usual: bool) -> Vec<&Finding> {
        let is_change =
            |f: &&Finding| f.family != Family::Q && f.present_in.iter().all(|kind| kind == "target");
        let is_beyond_chance = |f: &&Finding| f.evidence.p_null.is_some_and(|p| p <= self.settings.level);
        self.indications
            .iter()
            .filter(|i| i.usual == usual)
            .map(|i| &i.finding)
            .filter(is_change)
            .filter(is_beyond_chance)
            .collect()
    }
}

/// An effect that was found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// Identifier of the effect.
    pub effect: String,
    pub family: Family,
    /// The joints whose physics it is; of a whole-arm effect those whose error it explains.
    pub joints: Vec<usize>,
    /// Kinds of recordings that have it: `calibration`, `target`.
    pub present_in: Vec<String>,
    /// The recording it is confined to, if it is local in time.
    pub recording: Option<String>,
    /// Its window in that recording, s from the first stamp.
    pub window_s: Option<[f64; 2]>,
    /// Share of findings of such a score that were right in proofs on simulated robots.
    pub confidence: f64,
    /// Parameters under their canonical names; lists run along `joints`.
    pub parameters: Parameters,
    /// What else it could be: effects that would do as well on these data.
    pub alternatives: Vec<Alternative>,
    /// Why it was accepted.
    pub evidence: Evidence,
    /// The effect in a sentence.
    pub sentence: String,
}

impl Finding {
    /// An effect that was found by other means than selection, in one kind of recordings or in all.
    pub(crate) fn new(effect: &Effect, joints: Vec<usize>, evidence: Evidence, confidence: f64) -> Self {
        Self {
            effect: effect.id.to_owned(),
            family: effect.family,
            joints,
            present_in: Vec::new(),
            recording: None,
            window_s: None,
            confidence,
            parameters: Parameters::new(),
            alternatives: Vec::new(),
            evidence,
            sentence: String::new(),
        }
    }
}

/// An effect that describes the recordings and is not claimed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Indication {
    /// What it would be.
    pub finding: Finding,
    /// The tests that it fails.
    pub fails: Vec<String>,
    /// True for a change that is within what recordings of an unchanged robot differ by.
    pub usual: bool,
}

/// Something that could not be looked at.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NotExamined {
    /// The recording it concerns, if it is one.
    pub recording: Option<String>,
    /// The joints that it concerns.
    pub joints: Vec<usize>,
    /// The effects that it concerns; empty where it is all of them.
    pub effects: Vec<String>,
    /// Why, in a sentence that names the recording and the joints.
    pub reason: String,
}

/// A registered friction model that predicts what no named effect does.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RegisteredFinding {
    /// Its name in experiments.
    pub model: String,
    pub slot: Slot,
    /// Who registered it.
    pub origin: String,
    /// The joint whose friction it would be.
    pub joints: Vec<usize>,
    /// Kinds of recordings that have it: `calibration`, `target`.
    pub present_in: Vec<String>,
    /// Share of the joint's squared error without the model, with all else that was found, that the model predicts on
    /// blocks of time that were not fitted.
    pub predicted_share: f64,
    /// Shape parameters as they were tried, and fitted coefficients.
    pub parameters: Parameters,
    /// Why it was accepted.
    pub evidence: Evidence,
    /// The model in a sentence.
    pub sentence: String,
}

/// Another effect that would explain the same residual as well.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Alternative {
    /// Identifier of the effect.
    pub effect: String,
    /// Joints it would be on.
    pub joints: Vec<usize>,
    /// Its score in the place of the finding.
    pub score: f64,
    /// What to record to tell the two apart.
    pub record: String,
}

/// Score and threshold.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Evidence {
    /// Σ_j ½ n_eff log(MSE without / MSE with), cross-validated.
    pub score: f64,
    /// What it had to exceed.
    pub threshold: f64,
    /// Probability that chance alone makes such a finding: the larger of `p_null` and `p_confirm`, since both have to hold; of gears by
    /// Student's t of what they gain on parts of held-out time, for all gears that are looked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub p: Option<f64>,
    /// Probability that a search over all joints reaches such a score on its joints by chance: the same search on residuals
    /// circularly shifted against the motion, whose best scores have Gumbel's distribution.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub p_null: Option<f64>,
    /// Probability that rows which took no part in the search favour the effect as much by chance: a paired test over
    /// pieces of the held-out part.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub p_confirm: Option<f64>,
}

impl From<&Chosen> for Evidence {
    fn from(chosen: &Chosen) -> Self {
        let Chosen { score, threshold, p_null, p_confirm, .. } = *chosen;
        Self { score, threshold, p: chosen.by_chance(), p_null, p_confirm }
    }
}

impl Evidence {
    /// A score and what it had to exceed, without tests of chance.
    pub(crate) fn of(score: f64, threshold: f64) -> Self {
        Self { score, threshold, ..Self::default() }
    }
}

/// An effect that the free part of the baseline absorbs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NotDecidable {
    /// Identifier of the effect.
    pub effect: String,
    /// The joints for which it holds.
    pub joints: Vec<usize>,
    /// Share of its torque that the baseline absorbs.
    pub absorbed: f64,
    /// What would decide it.
    pub record: String,
}

/// What is left at a joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JointResidual {
    pub joint: usize,
    /// Root mean square of the baseline's residual, in the measurement's unit.
    pub baseline_rms: f64,
    /// Root mean square of what the named effects and registered models leave.
    pub unexplained_rms: f64,
    /// Root mean square that noise alone leaves.
    pub floor_rms: f64,
    /// Whether what is left is more than noise.
    pub structure_left: bool,
    /// The feature that the rest follows most, where trees predict it on held-out rows ([`Remainder::follows`]).
    pub follows: Option<String>,
    /// Share of the rest that they predict.
    pub follows_share: f64,
    /// Windows in which the rest stands out, s from the first stamp.
    pub windows_s: Vec<[f64; 2]>,
}

/// The improvement on held-out data: rows used neither in selection nor in fitting.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct HeldOut {
    /// The data used.
    pub recordings: Vec<String>,
    /// Root mean square of the residual before, joint by joint.
    pub rms_before: Vec<f64>,
    /// The same with the named effects.
    pub rms_after: Vec<f64>,
    /// What noise alone leaves.
    pub rms_floor: Vec<f64>,
}

impl HeldOut {
    /// Whether what was found makes a joint's error grow.
    pub fn is_worse(&self, joint: usize) -> bool {
        let error = |of: &[f64]| of.get(joint).copied().unwrap_or(f64::NAN);
        let (before, after) = (error(&self.rms_before), error(&self.rms_after));
        before > 0.0 && after.is_finite() && after > (1.0 + WORSE) * before
    }
}

/// A joint whose held-out rows the model does not describe, though it describes the rows that it was fitted to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct HeldOutDifference {
    pub joint: usize,
    /// Root mean square of the error on the held-out rows.
    pub rms: f64,
    /// The error that was to be expected there: noise, what the model leaves of the fitted rows in proportion to the torque, and
    /// the uncertainty of its coefficients (jackknife over blocks of time).
    pub expected_rms: f64,
}

/// A parameter of the rest of the model that the effects moved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Shift {
    /// Name.
    pub parameter: String,
    /// Value without the effects.
    pub before: f64,
    /// Value with them.
    pub after: f64,
    /// Difference in standard deviations.
    pub in_std: f64,
}
