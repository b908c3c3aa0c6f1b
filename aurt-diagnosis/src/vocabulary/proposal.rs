//! Terms that, added to a model, would describe an effect.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use crate::parameters::{ParameterValue, Parameters};
use crate::recordings::rows::{Instrument, RecordingRows};
use crate::vocabulary::shape::Shape;

/// What effects may look at when they propose terms.
#[derive(Debug, Clone, Copy)]
pub struct Context<'a> {
    /// Number of joints.
    pub joints: usize,
    /// Number of links, which are more than the joints where joints follow others.
    pub links: usize,
    /// Pairs of joints neither of which carries the other, the first before the second: those of two arms.
    pub apart: &'a [[usize; 2]],
    pub recordings: &'a [RecordingRows],
    /// Residual of the baseline, `[recording][joint]`.
    pub residual: &'a [Vec<Vec<f64>>],
    /// Indices of the baseline's standard inertial parameters and their fitted values.
    pub inertial: &'a [(usize, f64)],
    /// The travel of each joint below which positions are not told apart, rad.
    pub resolution_rad: &'a [f64],
}

/// Keys of terms that are exact around the values of their own first coefficients.
pub(crate) const AROUND: [&str; 2] = ["around_rad", "around_rad_nm"];

/// In which recordings an effect may be present.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Presence {
    /// Tried in all recordings and, where there are targets, in these alone.
    Any,
    /// Tried in the target recordings alone: a change.
    Change,
    /// Tried in all recordings alone: what the robot has.
    Structure,
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
    /// Another law with the same shapes, as a place in the term and the value there: once the proposal is confirmed, that which leaves
    /// less is taken.
    pub other_law: Option<(&'static str, Value)>,
}

/// The two kinds of additions.
#[derive(Debug, Clone, PartialEq)]
pub enum Addition {
    /// An arm term, as its configuration in an experiment.
    Term(Value),
    /// A column of the instrument.
    Instrument(usize, Instrument),
}

impl Proposal {
    /// A term on some joints, in any recordings, whose coefficients may have any sign.
    pub(crate) fn term(joints: Vec<usize>, term: Value) -> Self {
        Self {
            joints,
            addition: Addition::Term(term),
            nonnegative: Vec::new(),
            presence: Presence::Any,
            fixed: BTreeMap::new(),
            shapes: Vec::new(),
            starts: Vec::new(),
            deviations: BTreeMap::new(),
            other_law: None,
        }
    }

    /// A term for each joint.
    pub(crate) fn terms(joints: usize, model: &'static str) -> impl Iterator<Item = Self> {
        (0..joints).map(move |j| Self::term(vec![j], json!({ "model": model, "joints": [j] })))
    }

    /// A further stack for each joint: a level, of the sign of velocity, and powers of it.
    pub(crate) fn frictions(
        joints: usize,
        coulomb: &'static str,
        powers: &'static [u32],
    ) -> impl Iterator<Item = Self> {
        let [level, shape] = [coulomb, "sign"].map(|model| json!({ "model": model }));
        (0..joints).map(move |j| Self::friction(j, level.clone(), shape.clone(), powers))
    }

    /// A further stack of equation (6) on one joint, with the given powers of velocity.
    pub(crate) fn friction(joint: usize, coulomb: Value, hysteresis: Value, powers: &[u32]) -> Self {
        Self::stack(joint, coulomb, hysteresis, json!({ "model": "polynomial", "powers": powers }))
    }

    /// A further stack of equation (6) on one joint.
    pub(crate) fn stack(joint: usize, coulomb: Value, hysteresis: Value, viscous: Value) -> Self {
        let term = json!({
            "model": "joint_friction", "joints": [joint], "coulomb": coulomb, "hysteresis": hysteresis,
            "viscous": viscous,
        });
        Self::term(vec![joint], term)
    }

    /// A column of a joint's instrument.
    pub(crate) fn instrument(joints: Vec<usize>, joint: usize, which: Instrument) -> Self {
        Self { addition: Addition::Instrument(joint, which), ..Self::term(joints, Value::Null) }
    }

    /// The same, some of whose coefficients are physically bound to be ≥ 0.
    pub(crate) fn bound(self, nonnegative: &[bool]) -> Self {
        Self { nonnegative: nonnegative.to_vec(), ..self }
    }

    /// The same in the target recordings only.
    pub(crate) fn of_targets(self) -> Self {
        Self { presence: Presence::Change, ..self }
    }

    /// The same in all recordings only.
    pub(crate) fn of_all(self) -> Self {
        Self { presence: Presence::Structure, ..self }
    }

    /// The same with a parameter that the recordings decide; the term holds the value to start from.
    pub(crate) fn shaped(mut self, shape: Shape) -> Self {
        if let Addition::Term(term) = &self.addition
            && let Some(value) = shape.value(term)
        {
            self.fixed.insert(shape.name.to_owned(), value);
            self.starts.push(value);
            self.shapes.push(shape);
        }
        self
    }

    /// The same with another law.
    pub(crate) fn or_law(mut self, pointer: &'static str, law: Value) -> Self {
        self.other_law = Some((pointer, law));
        self
    }

    /// Swaps the two laws.
    pub(crate) fn swap_laws(&mut self) {
        if let (Addition::Term(term), Some((pointer, law))) = (&mut self.addition, &mut self.other_law)
            && let Some(own) = term.pointer_mut(pointer)
        {
            std::mem::swap(own, law);
        }
    }

    /// The same with a parameter that it fixes.
    pub(crate) fn with(mut self, name: &str, value: f64) -> Self {
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
    pub(crate) fn fixed_parameters(&self) -> Parameters {
        let of = |(name, value): (&String, &f64)| {
            let std = self.deviations.get(name).copied();
            (name.clone(), ParameterValue::new(*value, std))
        };
        self.fixed.iter().map(of).collect()
    }
}
