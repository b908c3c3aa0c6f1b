//! Hypotheses over the columns of candidates.

use crate::hypotheses::effects::{Kind, find};
use crate::hypotheses::registered::REGISTERED;

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
    /// Identifier of the effect.
    pub effect: &'static str,
    /// Joints whose physics it is.
    pub joints: Vec<usize>,
    /// Index of the candidate that it comes from.
    pub candidate: usize,
    /// Its coefficients.
    pub switches: Vec<Switch>,
    /// Those of them that are not what the effect is named for.
    pub accessory: Vec<Switch>,
}

impl Group {
    /// Whether it ties two joints together, and is not of the whole arm.
    pub(crate) fn is_tie(&self) -> bool {
        self.joints.len() == 2 && !find(self.effect).is_some_and(|e| e.whole_arm())
    }

    /// Whether it is of the vocabulary, and not a registered model.
    pub(crate) fn is_named(&self) -> bool {
        self.effect != REGISTERED
    }

    /// Whether a joint can have several of it.
    pub(crate) fn is_repeatable(&self) -> bool {
        find(self.effect).is_some_and(|e| e.repeatable())
    }

    /// Whether another effect is a simpler law that this one has to beat.
    pub(crate) fn generalises(&self, other: &Self) -> bool {
        find(self.effect).is_some_and(|e| e.generalises().contains(&other.effect))
            && self.joints == other.joints
            && self.target_only() == other.target_only()
    }

    /// Whether the effect is taken to act in the target recordings only.
    #[must_use]
    pub fn target_only(&self) -> bool {
        self.switches.first().is_some_and(|s| s.target_only)
    }
}

/// The force that an effect is about; registered models are friction.
pub(crate) fn kind(effect: &str) -> Kind {
    if effect == REGISTERED { Kind::Friction } else { find(effect).map_or(Kind::Other, |e| e.kind()) }
}

/// Whether an effect's change from one recording to the next is what real robots do.
pub(crate) fn is_friction(effect: &str) -> bool {
    effect == REGISTERED || find(effect).is_some_and(|e| e.everyday())
}

/// Whether two effects are the same force in other coordinates.
pub(crate) fn same_force(a: &str, b: &str) -> bool {
    find(a).is_some_and(|e| e.same_force().contains(&b))
}
