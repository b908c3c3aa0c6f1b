use serde::Serialize;

/// The factor by which rows are thinned out after the parallel filter.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Decimation {
    /// F_DS = 0.8 / (4 f_dyn T_S), the paper's formula (section IV), before rounding.
    pub exact: f64,
    /// The factor used: `exact` rounded, at least 1.
    pub factor: usize,
}

impl Decimation {
    /// The factor for dynamics up to `f_dyn_hz` sampled every `period_s`.
    #[must_use]
    pub fn new(f_dyn_hz: f64, period_s: f64) -> Self {
        let exact = 0.8 / (4.0 * f_dyn_hz * period_s);
        // Saturates where the quotient is beyond usize; the rounded value of a finite positive number is safe.
        Self { exact, factor: (exact.round() as usize).max(1) }
    }
}
