use thiserror::Error;

/// What a model or a request to it gives: nothing, unless something is wrong.
pub type Result<T = (), E = ModelError> = std::result::Result<T, E>;

/// What can be wrong with a model or with a request to it.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages name the fields")]
pub enum ModelError {
    /// A parameter of the model's configuration has a value that the model cannot work with.
    #[error("model `{model}`: `{parameter}` {reason}")]
    InvalidParameter {
        model: String,
        parameter: String,
        /// What is wrong, as the rest of a sentence ("must be positive, is -1").
        reason: String,
    },
    /// The model failed while it was evaluated (a plugin's error or panic, a value that is not finite).
    #[error("model `{model}` failed: {reason}")]
    Evaluation { model: String, reason: String },
    /// A model was put into a slot of equation (6) whose invariant it does not declare.
    #[error(
        "model `{model}` cannot be the {slot} model: it is not {invariant} (equation (6) asks for it); {remedy}"
    )]
    SlotRefused {
        model: String,
        slot: &'static str,
        /// The invariant that is missing, in words.
        invariant: &'static str,
        remedy: String,
    },
    /// Two things that must have the same number of entries do not.
    #[error("{what}: expected {expected}, got {found}")]
    Count { what: String, expected: usize, found: usize },
    /// An instruction set was asked for by a name that is not known, or that this processor does not have.
    #[error("SIMD level `{asked}` {reason}; available here: {available}")]
    InstructionSet {
        asked: String,
        reason: &'static str,
        /// What can be had, comma separated.
        available: String,
    },
}

impl ModelError {
    /// [`Self::InvalidParameter`]: `reason` is the rest of the sentence that `parameter` of `model` begins.
    pub fn parameter(
        model: impl Into<String>,
        parameter: impl Into<String>,
        reason: impl Into<String>,
    ) -> Self {
        Self::InvalidParameter { model: model.into(), parameter: parameter.into(), reason: reason.into() }
    }

    /// [`Self::Evaluation`].
    pub fn evaluation(model: impl Into<String>, reason: impl Into<String>) -> Self {
        Self::Evaluation { model: model.into(), reason: reason.into() }
    }

    /// [`Self::Count`].
    pub fn count(what: impl Into<String>, expected: usize, found: usize) -> Self {
        Self::Count { what: what.into(), expected, found }
    }
}
