//! Hypotheses over the columns of candidates.

use crate::hypotheses::registered::REGISTERED;
use crate::vocabulary::Effect;

/// A coefficient that a hypothesis may use: a column of the robot model, in all recordings or in the target
/// recordings alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Switch {
    /// Column of the robot model.
    pub column: usize,
    /// Whether the coefficient acts in the target recordings only.
    pub target_only: bool,
    /// Whether physics forbids a negative value.
    pub nonnegative: bool,
}

/// A hypothesis: coefficients that enter or leave the model together.
#[derive(Debug, Clone)]
pub struct Group {
    /// The effect; `REGISTERED` for a registered model.
    pub effect: &'static Effect,
    /// Joints whose physics it is.
    pub joints: Vec<usize>,
    /// Index of the candidate that it comes from.
    pub candidate: usize,
    /// Its coefficients.
    pub switches: Vec<Switch>,
    /// Those of them that are not what the effect is named for.
    pub accessory: Vec<Switch>,
    /// Number of shape parameters that are estimated beside them.
    pub shapes: usize,
}

impl Group {
    /// Whether it ties two joints together, and is not of the whole arm.
    pub(crate) fn is_tie(&self) -> bool {
        self.joints.len() == 2 && !self.effect.is_whole_arm
    }

    /// Whether it is of the vocabulary, and not a registered model.
    pub(crate) fn is_named(&self) -> bool {
        *self.effect != REGISTERED
    }

    /// Number of parameters that are estimated: coefficients and shapes.
    pub(crate) fn freedoms(&self) -> usize {
        self.switches.len() + self.shapes
    }

    /// True for a simpler law, or form of the same effect, of fewer freedoms on this model: this one has to beat it.
    pub(crate) fn generalises(&self, other: &Self) -> bool {
        self.effect.generalises.contains(&other.effect)
            && other.freedoms() < self.freedoms()
            && self.joints == other.joints
            && self.target_only() == other.target_only()
    }

    /// Whether the effect is taken to act in the target recordings only.
    pub fn target_only(&self) -> bool {
        self.switches.first().is_some_and(|s| s.target_only)
    }
}
