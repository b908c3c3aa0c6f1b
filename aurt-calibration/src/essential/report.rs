use serde::{Deserialize, Serialize};

/// What elimination found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EssentialReport {
    /// Blocks of time, each predicted by a fit to the others.
    pub blocks: usize,
    /// Parameters that the recordings determine.
    pub parameters: usize,
    /// Those that were kept.
    pub kept: usize,
    /// Mean squared error of the blocks with all parameters, in σ_j².
    pub held_out_error: f64,
    /// The eliminations in their order; those after the first significant one are shown, and were not made.
    pub steps: Vec<EssentialStep>,
}

/// A parameter less.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EssentialStep {
    /// The parameter.
    pub parameter: String,
    /// By how much the weighted squared residual of the fit grows without it.
    pub chi_squared: f64,
    /// Mean squared error of the blocks without it and all before it, in σ_j².
    pub held_out_error: f64,
    /// Growth of that over the best set before.
    pub growth: f64,
    /// Standard deviation of the growth over the blocks.
    pub growth_std: f64,
    /// Whether the growth is significant.
    pub significant: bool,
    /// Whether the parameter was eliminated.
    pub eliminated: bool,
}

impl EssentialReport {
    /// Names of the eliminated parameters, in order.
    pub fn eliminated(&self) -> impl Iterator<Item = &str> {
        self.steps.iter().filter(|s| s.eliminated).map(|s| s.parameter.as_str())
    }
}
