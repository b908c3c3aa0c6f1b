//! The physics that AURT knows to name: one effect a file.
//!
//! An effect proposes [`Proposal`]s: terms that, added to the model, would describe it. Selection decides
//! among all proposals of all effects without knowing which is which. The module documentation of each file is
//! what `aurt explain <identifier>` prints.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use aurt_traits::{ColumnGroup, RobotModel};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::hypotheses::shape::Shape;
pub use crate::recordings::faults::Parameters;
use crate::recordings::rows::{Instrument, RecordingRows};

mod backlash;
mod base_tilt;
mod coulomb;
mod coulomb_asymmetry;
mod current_offset;
mod drive_efficiency;
mod dropped_samples;
mod external_contact;
mod friction_level_changed;
mod joint_coupling_friction;
mod joint_elasticity;
mod load_dependent_friction;
mod payload;
mod presliding_hysteresis;
mod rotor_inertia;
mod saturation;
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

/// The force that an effect is about: a second effect of one kind at the same joint needs stronger evidence.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Friction of the joint.
    Friction,
    /// In proportion to the load or the measurement.
    Load,
    /// With acceleration or the slope of torque.
    Acceleration,
    /// With the angle.
    Position,
    /// None of these.
    Other,
}

/// What effects may look at when they propose terms.
#[derive(Debug, Clone, Copy)]
pub struct Context<'a> {
    /// Number of joints.
    pub joints: usize,
    /// Number of links, which are more than the joints where joints follow others.
    pub links: usize,
    /// The recordings' rows.
    pub recordings: &'a [RecordingRows],
    /// Residual of the baseline, `[recording][joint]`.
    pub residual: &'a [Vec<Vec<f64>>],
    /// Indices of the baseline's standard inertial parameters and their fitted values.
    pub inertial: &'a [(usize, f64)],
    /// The travel of each joint below which positions are not told apart, rad.
    pub resolution_rad: &'a [f64],
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
    /// Those of them that the recordings decide, once the proposal is taken; `fixed` and the term hold their values.
    pub shapes: Vec<Shape>,
    /// The values from which their search begins.
    pub starts: Vec<f64>,
    /// Standard deviations of those that were estimated.
    pub deviations: BTreeMap<String, f64>,
}

/// The two kinds of additions.
#[derive(Debug, Clone, PartialEq)]
pub enum Addition {
    /// An arm term, as its configuration in an experiment.
    Term(Value),
    /// A column of the instrument.
    Instrument(usize, Instrument),
}

/// A coefficient of a proposal as it was fitted: name, value, standard deviation. A coefficient that the
/// baseline absorbs has the value 0 and an infinite deviation.
pub type FittedColumn = (String, f64, f64);

/// The friction of a joint's own stack in a fit, on top of which the coefficients of proposals come.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OwnFriction {
    /// Level of dry friction at full sliding without load, Nm.
    pub coulomb_nm: f64,
    /// Linear viscous friction, Nm s/rad.
    pub viscous_nm_s: f64,
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

    /// Whether it concerns every joint, whether the joint's error shows it or not.
    fn concerns_all(&self) -> bool {
        false
    }

    /// Whether a coefficient of its proposals, counted from 0, is what the effect is named for. Without what these bring
    /// by themselves the rest is another effect: a motor's inertia is no coupling *friction*, a constant no spring.
    fn is_essential(&self, coefficient: usize) -> bool {
        let _ = coefficient;
        true
    }

    /// The force that it is about.
    fn kind(&self) -> Kind {
        Kind::Other
    }

    /// Whether it changes from one recording to the next on real robots that nobody has touched.
    fn everyday(&self) -> bool {
        self.kind() == Kind::Friction
    }

    /// Whether a joint can have several of it: ripple has many orders. A second law of friction of the same name with
    /// other shapes mimics what is not among the candidates.
    fn repeatable(&self) -> bool {
        false
    }

    /// Simpler laws that it contains or that are hard to tell from it: they keep their name unless it describes
    /// held-out rows better by the least score of an effect.
    fn generalises(&self) -> &'static [&'static str] {
        &[]
    }

    /// Effects that are the same force in other coordinates.
    fn same_force(&self) -> &'static [&'static str] {
        &[]
    }

    /// Whether it makes friction come late at reversals, as a delay of the measurement does.
    fn lags(&self) -> bool {
        false
    }

    /// Whether its columns are made of the model's own coefficients, and change with them.
    fn reads_model(&self) -> bool {
        false
    }

    /// Terms that would describe the effect on this robot; none where it is found by other means than columns
    /// of a regressor.
    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal>;

    /// The effect's parameters under their canonical names, from the fitted coefficients of a proposal.
    fn parameters(&self, proposal: &Proposal, fitted: &[FittedColumn]) -> Parameters;

    /// The same where the joint's own friction in the same fit is known, so that levels are whole levels and
    /// not what comes on top of the model's.
    fn parameters_beside(
        &self,
        proposal: &Proposal,
        fitted: &[FittedColumn],
        own: &OwnFriction,
    ) -> Parameters {
        let _ = own;
        self.parameters(proposal, fitted)
    }

    /// The effect with its first parameters as a phrase, where its title and a list of parameters say it badly.
    fn phrase(&self, parameters: &BTreeMap<String, ParameterValue>) -> Option<String> {
        let _ = parameters;
        None
    }

    /// Why no machine has these parameters; `None` where they are possible, or within two standard deviations of what
    /// is. `reach_m` is the longest lever of the arm that the recordings show.
    fn impossible(&self, parameters: &Parameters, reach_m: f64) -> Option<String> {
        let _ = reach_m;
        NEVER_NEGATIVE.iter().find_map(|name| negative(parameters, name))
    }
}

/// Parameters of friction and inertia that take energy from the arm, or store it: a negative one would drive it.
const NEVER_NEGATIVE: [&str; 11] = [
    "coulomb_nm",
    "coulomb_neg_nm",
    "coulomb_pos_nm",
    "inertia_kg_m2",
    "new_coulomb_nm",
    "new_viscous_nm_s",
    "static_nm",
    "stiffness_nm_rad",
    "viscous_neg_nm_s",
    "viscous_nm_s",
    "viscous_pos_nm_s",
];

/// A parameter that is negative by more than two standard deviations, in words.
fn negative(parameters: &Parameters, name: &str) -> Option<String> {
    let (value, std) = parameters.get(name)?;
    let (value, std) = (value.as_f64()?, std.as_f64().unwrap_or(0.0));
    (value + 2.0 * std < 0.0).then(|| format!("{name} is {value:.3} ± {std:.3}, and cannot be negative"))
}

/// All effects, by family and identifier.
#[must_use]
pub fn all() -> Vec<&'static dyn Effect> {
    ALL.clone()
}

static ALL: LazyLock<Vec<&'static dyn Effect>> = LazyLock::new(|| {
    let mut effects: Vec<&'static dyn Effect> = vec![
        &backlash::Backlash,
        &base_tilt::BaseTilt,
        &coulomb::Coulomb,
        &coulomb_asymmetry::CoulombAsymmetry,
        &current_offset::CurrentOffset,
        &drive_efficiency::DriveEfficiency,
        &dropped_samples::DroppedSamples,
        &external_contact::ExternalContact,
        &friction_level_changed::FrictionLevelChanged,
        &joint_coupling_friction::JointCouplingFriction,
        &joint_elasticity::JointElasticity,
        &load_dependent_friction::LoadDependentFriction,
        &payload::Payload,
        &presliding_hysteresis::PreslidingHysteresis,
        &rotor_inertia::RotorInertia,
        &saturation::Saturation,
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
});

/// The effect of an identifier.
#[must_use]
pub fn find(id: &str) -> Option<&'static dyn Effect> {
    ALL.iter().copied().find(|e| e.id() == id)
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
            shapes: Vec::new(),
            starts: Vec::new(),
            deviations: BTreeMap::new(),
        }
    }

    fn instrument(joint: usize, which: Instrument, nonnegative: bool) -> Self {
        Self {
            joints: vec![joint],
            addition: Addition::Instrument(joint, which),
            nonnegative: vec![nonnegative],
            presence: Presence::Any,
            fixed: BTreeMap::new(),
            shapes: Vec::new(),
            starts: Vec::new(),
            deviations: BTreeMap::new(),
        }
    }

    /// A parameter that the recordings decide; the term holds the value to start from.
    fn shaped(mut self, shape: Shape) -> Self {
        if let Addition::Term(term) = &self.addition
            && let Some(value) = shape.value(term)
        {
            self.fixed.insert(shape.name.to_owned(), value);
            self.starts.push(value);
            self.shapes.push(shape);
        }
        self
    }

    fn with(mut self, name: &str, value: f64) -> Self {
        self.fixed.insert(name.to_owned(), value);
        self
    }

    /// The proposal's shapes at other values, with their standard deviations where these are known.
    pub(crate) fn reshaped(&mut self, values: &[f64], deviations: &[Option<f64>]) {
        for ((shape, value), deviation) in self.shapes.iter().zip(values).zip(deviations) {
            if let Addition::Term(term) = &mut self.addition {
                shape.set(term, *value);
            }
            self.fixed.insert(shape.name.to_owned(), *value);
            match deviation {
                Some(std) => self.deviations.insert(shape.name.to_owned(), *std),
                None => self.deviations.remove(shape.name),
            };
        }
    }

    /// The parameters that the proposal fixes, as a finding reports them.
    #[must_use]
    pub fn fixed_parameters(&self) -> Parameters {
        let deviation = |name: &String| self.deviations.get(name).map_or(Value::Null, |std| json!(std));
        self.fixed.iter().map(|(name, value)| (name.clone(), (json!(value), deviation(name)))).collect()
    }
}

impl OwnFriction {
    /// The friction of a joint's stack; `coefficients` are those of a fit over the model's columns, at least
    /// up to the joint dynamics.
    #[must_use]
    pub fn of(model: &RobotModel, joint: usize, coefficients: &[f64]) -> Self {
        let mut own = Self::default();
        let Some(stack) = model.stacks().get(joint) else { return own };
        let range = model.group(ColumnGroup::JointDynamics(joint));
        let dry = stack.coulomb().columns().len() * stack.hysteresis().columns().len();
        for (k, (column, value)) in
            stack.columns().iter().zip(coefficients.iter().skip(range.start)).enumerate()
        {
            // An excess near rest (`dF_S…`) is gone at full sliding.
            if k < dry && column.unit == "Nm" && !column.name.starts_with("dF") {
                own.coulomb_nm += value;
            } else if k >= dry && column.unit == "Nm s/rad" {
                own.viscous_nm_s += value;
            }
        }
        own
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
fn named(names: &[&str], fitted: &[FittedColumn]) -> Parameters {
    names
        .iter()
        .zip(fitted)
        .map(|(name, (_, value, std))| ((*name).to_owned(), (json!(value), json!(std))))
        .collect()
}

/// Coefficients on top of a level that the model has already.
fn raised(fitted: &[FittedColumn], by: f64) -> Vec<FittedColumn> {
    fitted.iter().map(|(name, value, std)| (name.clone(), value + by, *std)).collect()
}
