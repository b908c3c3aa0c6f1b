//! How series look.

/// What a layer is of, and so its colour and dashes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    Measured,
    Predicted,
    /// The model without what was found.
    Before,
    After,
    /// What noise alone leaves.
    Floor,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// Joined by a line; values that are not finite interrupt it.
    Line,
    Points,
    /// Joined by a thick line, over points.
    Means,
}
