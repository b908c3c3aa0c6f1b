//! The descriptor of an effect.

use aurt_calibration::with_deviation;
use aurt_traits::{MeasurementUnit, RobotNames};
use serde::{Deserialize, Serialize};

use crate::parameters::{FittedColumn, ParameterValue, Parameters};
use crate::vocabulary::own_friction::OwnFriction;
use crate::vocabulary::parameter::Parameter;
use crate::vocabulary::proposal::{Context, Proposal};

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

/// By which means an effect is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Means {
    /// Columns of the regressor, which it proposes.
    Columns,
    /// The samples of the recordings as read.
    Samples,
    /// A simulation of the gear at the recordings' own rate; an elastic one proposes columns as well.
    FullRate,
    /// Stretches of time in the residual.
    Windows,
}

/// What the fitted coefficients of a proposal mean, on a joint with the given friction of its own.
pub type Estimate = fn(&Proposal, &[FittedColumn], &OwnFriction) -> Parameters;

/// A physical effect that a model may lack: everything that the rest of a diagnosis has to know of it.
#[derive(Debug)]
pub struct Effect {
    /// Identifier, and name of the effect's file.
    pub id: &'static str,
    pub family: Family,
    /// The effect in a few words, to be used in a sentence.
    pub title: &'static str,
    /// What to record to tell it from what it is confused with.
    pub decider: &'static str,
    /// The source text of the file, whose module documentation explains the effect.
    pub source: &'static str,
    /// Its parameters: those of the fitted coefficients in their order, then those that proposals fix.
    pub parameters: &'static [Parameter],
    /// How it is found.
    pub means: Means,
    /// The force that it is about.
    pub kind: Kind,
    /// Whether it is friction, which differs from one recording to the next on real robots that nobody has touched.
    pub is_friction: bool,
    /// Whether one finding concerns the whole arm.
    pub is_whole_arm: bool,
    /// Whether it concerns every joint, whether the joint's error shows it or not.
    pub concerns_all_joints: bool,
    /// Whether a joint can have several of it: ripple has many orders. A second law of friction of the same name with
    /// other shapes mimics what is not among the candidates.
    pub is_repeatable: bool,
    /// True for a law that is free on every joint while a delay is judged: friction that lags looks like one, missing inertia hides one.
    pub stays_beside_delays: bool,
    /// Whether its columns are made of the model's own coefficients, and change with them.
    pub reads_model: bool,
    /// Whether its proposals follow from the baseline's residual, and change with it.
    pub reads_residual: bool,
    /// Simpler laws that it contains or that are hard to tell from it, itself where it has simpler forms: they are preferred unless it
    /// describes held-out rows better by the least score and the least share of an effect.
    pub generalises: &'static [&'static Effect],
    /// Effects that are the same force in other coordinates; one of two declares it.
    pub same_force: &'static [&'static Effect],
    /// The effect that is the same force in recordings in which these loads act on its joint, Nm.
    pub same_under: fn(&[f64]) -> Option<&'static Effect>,
    /// Whether a coefficient of its proposals, counted from 0, is what the effect is named for. Without these, the others
    /// are another effect: a motor's inertia is no coupling *friction*, a constant no spring.
    pub is_essential: fn(usize) -> bool,
    /// The sum of weighted coefficients that the effect is named for, where it is not all that are essential: friction of one level in both
    /// directions does not differ by direction.
    pub contrast: &'static [f64],
    /// Terms that would describe the effect on this robot; none where it is found by other means.
    pub propose: fn(&Context<'_>) -> Vec<Proposal>,
    /// Its parameters beside the joint's own friction, where they are not the fitted coefficients themselves.
    pub estimate: Option<Estimate>,
    /// The effect in words, where title and a list of parameters are hard to read.
    pub wording: Option<fn(&Parameters, MeasurementUnit, RobotNames<'_>) -> Wording>,
    /// Why no machine has these parameters, beyond the signs of `Parameter::never_negative`. The length is the longest
    /// lever of the arm that the recordings show, m.
    pub excludes: fn(&Parameters, f64) -> Option<String>,
}

/// A found effect in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Wording {
    /// The effect with its first parameter: `a payload of 2 kg on wrist_3_link`.
    pub phrase: String,
    /// Further parameters; may be empty.
    pub detail: String,
}

impl Effect {
    /// What most effects have in common; a descriptor states the rest.
    pub(crate) const BASE: Self = Self {
        id: "",
        family: Family::F,
        title: "",
        decider: "",
        source: "",
        parameters: &[],
        means: Means::Columns,
        kind: Kind::Other,
        is_friction: false,
        is_whole_arm: false,
        concerns_all_joints: false,
        is_repeatable: false,
        stays_beside_delays: false,
        reads_model: false,
        reads_residual: false,
        generalises: &[],
        same_force: &[],
        same_under: |_| None,
        is_essential: |_| true,
        contrast: &[],
        propose: |_| Vec::new(),
        estimate: None,
        wording: None,
        excludes: |_, _| None,
    };

    /// The same for friction of a joint.
    pub(crate) const FRICTION: Self = Self { kind: Kind::Friction, is_friction: true, ..Self::BASE };

    /// The explanation of the effect: the module documentation of its file.
    pub fn explanation(&self) -> String {
        let lines = self.source.lines().map_while(|line| line.strip_prefix("//!"));
        lines.map(|line| line.strip_prefix(' ').unwrap_or(line)).collect::<Vec<_>>().join("\n")
    }

    /// The item of the explanation on a parameter.
    pub fn meaning(&self, parameter: &str) -> Option<String> {
        self.parameter(parameter)?;
        let (page, quoted) = (self.explanation(), format!("`{parameter}`"));
        let item = page.split("\n- ").skip(1).find(|item| item.contains(&quoted))?;
        let words: Vec<&str> = item.split("\n\n").next()?.split_whitespace().collect();
        Some(words.join(" "))
    }

    /// The parameter of a canonical name.
    pub fn parameter(&self, name: &str) -> Option<&'static Parameter> {
        self.parameters.iter().find(|p| p.name == name)
    }

    /// Whether two effects are the same force in other coordinates.
    pub(crate) fn is_same_force(&self, other: &Self) -> bool {
        self.same_force.contains(&other) || other.same_force.contains(&self)
    }

    /// The parameters that the fitted coefficients of a proposal mean, on a joint with the given friction of its own.
    pub(crate) fn estimated(
        &self,
        proposal: &Proposal,
        fitted: &[FittedColumn],
        own: &OwnFriction,
    ) -> Parameters {
        match self.estimate {
            Some(estimate) => estimate(proposal, fitted, own),
            None => self.named(proposal, fitted),
        }
    }

    /// The fitted coefficients under the names of the parameters, and what the proposal fixes.
    pub(crate) fn named(&self, proposal: &Proposal, fitted: &[FittedColumn]) -> Parameters {
        let coefficients = self.parameters.iter().zip(fitted);
        coefficients
            .map(|(p, (_, value, std))| (p.name.to_owned(), ParameterValue::new(*value, *std)))
            .chain(proposal.fixed_parameters())
            .collect()
    }

    /// Why no machine has these parameters; `None` where they are possible, or within two standard deviations of what
    /// is. `reach_m` is the longest lever of the arm that the recordings show.
    pub(crate) fn impossible(&self, parameters: &Parameters, reach_m: f64) -> Option<String> {
        let negative = |p: &Parameter| {
            let [value, std] = parameters.get(p.name)?.number()?;
            (value + 2.0 * std < 0.0)
                .then(|| format!("{} is {}, and cannot be negative", p.name, with_deviation(value, std)))
        };
        let bound = self.parameters.iter().filter(|p| p.never_negative);
        bound.filter_map(negative).next().or_else(|| (self.excludes)(parameters, reach_m))
    }
}

impl PartialEq for Effect {
    fn eq(&self, other: &Self) -> bool {
        self.id == other.id
    }
}

impl Eq for Effect {}
