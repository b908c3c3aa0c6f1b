//! The physics that AURT knows to name: one effect a file.
//!
//! An effect proposes [`Proposal`]s: terms that, added to the model, would describe it. Selection decides
//! among all proposals of all effects without knowing which is which. The module documentation of each file is
//! what `aurt explain <identifier>` prints.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::{Instrument, RecordingRows};

mod base_tilt;
mod coulomb;
mod coulomb_asymmetry;
mod current_offset;
mod drive_efficiency;
mod friction_level_changed;
mod joint_coupling_friction;
mod joint_elasticity;
mod load_dependent_friction;
mod payload;
mod presliding_hysteresis;
mod rotor_inertia;
mod spring;
mod stribeck;
mod temperature_dependent_friction;
mod time_delay;
mod torque_constant;
mod torque_ripple;
mod viscous;
mod viscous_asymmetry;
mod viscous_nonlinear;

/// Family of an effect, by its letter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Family {
    /// Dry friction.
    F,
    /// Viscous friction.
    V,
    /// Memory (hysteresis).
    H,
    /// Load.
    L,
    /// Inertia and gravity.
    I,
    /// Position.
    P,
    /// Drive and instrument.
    D,
    /// Coupling between joints.
    C,
    /// External forces.
    X,
    /// Data quality.
    Q,
}

/// What effects may look at when they propose terms.
#[derive(Debug, Clone, Copy)]
pub struct Context<'a> {
    /// Number of joints.
    pub joints: usize,
    /// The recordings' rows.
    pub recordings: &'a [RecordingRows],
    /// Residual of the baseline, `[recording][joint]`.
    pub residual: &'a [Vec<Vec<f64>>],
    /// Indices of the baseline's standard inertial parameters and their fitted values.
    pub inertial: &'a [(usize, f64)],
}

/// In which recordings an effect may be present.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Presence {
    /// Tried in all recordings and, where there are targets, in these alone.
    Any,
    /// Tried in the target recordings alone: a change.
    Change,
}

/// Something that, added to the model, would describe an effect.
#[derive(Debug, Clone)]
pub struct Proposal {
    /// The joints whose physics it is; of a whole-arm effect, all.
    pub joints: Vec<usize>,
    /// What is added.
    pub addition: Addition,
    /// Whether each coefficient is physically bound to be ≥ 0; shorter lists are filled with false.
    pub nonnegative: Vec<bool>,
    /// In which recordings.
    pub presence: Presence,
    /// Parameters that the proposal fixes (partner, ratio, link, order).
    pub fixed: BTreeMap<String, f64>,
}

/// The two kinds of additions.
#[derive(Debug, Clone, PartialEq)]
pub enum Addition {
    /// An arm term, as its configuration in an experiment.
    Term(Value),
    /// A column of the instrument.
    Instrument(usize, Instrument),
}

/// An estimate with its standard deviation, or several along the joints of a finding.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ParameterValue {
    /// Value: a number, or a list along the finding's joints.
    pub value: Value,
    /// Standard deviation, of the same shape.
    pub std: Value,
}

/// A physical effect that a model may lack.
pub trait Effect: Sync {
    /// Identifier, the one of the vocabulary and the file's name.
    fn id(&self) -> &'static str;

    /// Its family.
    fn family(&self) -> Family;

    /// The effect in a few words, to be used in a sentence.
    fn title(&self) -> &'static str;

    /// What to record to tell it from what it is confused with.
    fn decider(&self) -> &'static str;

    /// The source text of the file, whose module documentation explains the effect.
    fn source(&self) -> &'static str;

    /// Whether one finding concerns the whole arm.
    fn whole_arm(&self) -> bool {
        false
    }

    /// Terms that would describe the effect on this robot.
    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal>;

    /// The effect's parameters under their canonical names from the fitted coefficients (name, value,
    /// standard deviation) of a proposal.
    fn parameters(
        &self,
        proposal: &Proposal,
        fitted: &[(String, f64, f64)],
    ) -> BTreeMap<String, (Value, Value)>;
}

/// All effects, by family and identifier.
#[must_use]
pub fn all() -> Vec<&'static dyn Effect> {
    let mut effects: Vec<&'static dyn Effect> = vec![
        &base_tilt::BaseTilt,
        &coulomb::Coulomb,
        &coulomb_asymmetry::CoulombAsymmetry,
        &current_offset::CurrentOffset,
        &drive_efficiency::DriveEfficiency,
        &friction_level_changed::FrictionLevelChanged,
        &joint_coupling_friction::JointCouplingFriction,
        &joint_elasticity::JointElasticity,
        &load_dependent_friction::LoadDependentFriction,
        &payload::Payload,
        &presliding_hysteresis::PreslidingHysteresis,
        &rotor_inertia::RotorInertia,
        &spring::Spring,
        &stribeck::Stribeck,
        &temperature_dependent_friction::TemperatureDependentFriction,
        &time_delay::TimeDelay,
        &torque_constant::TorqueConstant,
        &torque_ripple::TorqueRipple,
        &viscous::Viscous,
        &viscous_asymmetry::ViscousAsymmetry,
        &viscous_nonlinear::ViscousNonlinear,
    ];
    effects.sort_by_key(|e| (e.family(), e.id()));
    effects
}

/// The effect of an identifier.
#[must_use]
pub fn find(id: &str) -> Option<&'static dyn Effect> {
    all().into_iter().find(|e| e.id() == id)
}

/// The explanation of an effect: the module documentation of its file.
#[must_use]
pub fn explain(effect: &dyn Effect) -> String {
    effect
        .source()
        .lines()
        .take_while(|l| l.starts_with("//!"))
        .map(|l| l.trim_start_matches("//!").trim_start_matches(' '))
        .collect::<Vec<_>>()
        .join("\n")
}

impl Proposal {
    /// A term on one joint, in any recordings.
    fn on_joint(joint: usize, term: Value, nonnegative: Vec<bool>) -> Self {
        Self {
            joints: vec![joint],
            addition: Addition::Term(term),
            nonnegative,
            presence: Presence::Any,
            fixed: BTreeMap::new(),
        }
    }

    fn instrument(joint: usize, which: Instrument, nonnegative: bool) -> Self {
        Self {
            joints: vec![joint],
            addition: Addition::Instrument(joint, which),
            nonnegative: vec![nonnegative],
            presence: Presence::Any,
            fixed: BTreeMap::new(),
        }
    }

    fn with(mut self, name: &str, value: f64) -> Self {
        self.fixed.insert(name.to_owned(), value);
        self
    }
}

/// A further stack of equation (6) on one joint, as an arm term.
fn joint_friction(joint: usize, coulomb: Value, hysteresis: Value, powers: &[u32]) -> Value {
    json!({
        "model": "joint_friction", "joints": [joint], "coulomb": coulomb, "hysteresis": hysteresis,
        "viscous": { "model": "polynomial", "powers": powers },
    })
}

/// Canonical names for the fitted coefficients, in order.
fn named(names: &[&str], fitted: &[(String, f64, f64)]) -> BTreeMap<String, (Value, Value)> {
    names
        .iter()
        .zip(fitted)
        .map(|(name, (_, value, std))| ((*name).to_owned(), (json!(value), json!(std))))
        .collect()
}
