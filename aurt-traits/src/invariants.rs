use serde::{Deserialize, Serialize};

/// A property that a model declares of itself and that the property tests hold it to.
///
/// "Column" below means each output column of the model, before any coefficient.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Invariant {
    /// Every column has the same value at τ_J and −τ_J.
    EvenInLoad,
    /// Every column is ≥ 0, and at least one column is > 0 everywhere.
    Positive,
    /// |column| ≤ 1 for all inputs and states.
    BoundedByOne,
    /// Every column changes its sign with q̇ (for models with memory: with the whole motion).
    OddInVelocity,
    /// Every column is a continuous function of q̇ (no step at rest).
    ContinuousInVelocity,
    /// Every column has the sign of q̇, or is zero.
    SignOfVelocity,
    /// Over any closed cycle of motion the work ∫ column · q̇ dt is ≥ 0.
    Passive,
    /// The output depends on the path, not on how fast it is travelled.
    RateIndependent,
    /// The output at a sample depends on that sample alone.
    Memoryless,
}

impl Invariant {
    /// All invariants, in the order of their declaration.
    pub const ALL: [Self; 9] = [
        Self::EvenInLoad,
        Self::Positive,
        Self::BoundedByOne,
        Self::OddInVelocity,
        Self::ContinuousInVelocity,
        Self::SignOfVelocity,
        Self::Passive,
        Self::RateIndependent,
        Self::Memoryless,
    ];

    /// The invariant in words, as the rest of "it is …".
    pub const fn in_words(self) -> &'static str {
        match self {
            Self::EvenInLoad => "even in the load torque",
            Self::Positive => "strictly positive",
            Self::BoundedByOne => "bounded by one in magnitude",
            Self::OddInVelocity => "odd in velocity",
            Self::ContinuousInVelocity => "continuous in velocity",
            Self::SignOfVelocity => "of the sign of velocity",
            Self::Passive => "passive",
            Self::RateIndependent => "rate-independent",
            Self::Memoryless => "memoryless",
        }
    }
}

/// A set of [`Invariant`]s.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Invariants(u32);

impl Invariants {
    /// The empty set.
    pub const NONE: Self = Self(0);

    /// The set of the given invariants.
    pub const fn of(list: &[Invariant]) -> Self {
        let mut bits = 0;
        let mut i = 0;
        while i < list.len() {
            bits |= 1 << list[i] as u32;
            i += 1;
        }
        Self(bits)
    }

    /// The set with `invariant` too, if it holds.
    #[must_use]
    pub const fn with(self, invariant: Invariant, holds: bool) -> Self {
        Self(self.0 | (holds as u32) << invariant as u32)
    }

    /// Whether `invariant` is in the set.
    pub const fn contains(self, invariant: Invariant) -> bool {
        self.0 & (1 << invariant as u32) != 0
    }

    /// The members, in the order of [`Invariant::ALL`].
    pub fn iter(self) -> impl Iterator<Item = Invariant> {
        Invariant::ALL.into_iter().filter(move |i| self.contains(*i))
    }

    /// The set as a bit mask (bit k is `Invariant::ALL[k]`), as the plugin ABI carries it.
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// The set of a bit mask; unknown bits are dropped.
    pub const fn from_bits(bits: u32) -> Self {
        Self(bits & ((1 << Invariant::ALL.len()) - 1))
    }
}
