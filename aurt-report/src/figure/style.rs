//! How series look.

/// What a layer is of, and so its colour and dashes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// What was measured.
    Measured,
    /// What a model predicts.
    Predicted,
    /// The model without what was found.
    Before,
    /// The model with it.
    After,
    /// What noise alone leaves.
    Floor,
}

/// How the values of a layer are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// Joined by a line; values that are not finite interrupt it.
    Line,
    /// Each for itself.
    Points,
    /// Joined by a thick line, over points.
    Means,
}
