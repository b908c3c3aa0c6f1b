use std::ops::Range;

use aurt_traits::{MeasurementUnit, RobotModel};

use crate::{CalibratedParameter, CalibrationOptions, JointRange, with_deviation};

/// A contradiction is one if it exceeds this many standard deviations.
const BEYOND_NOISE: f64 = 2.0;

/// A calibrated model, to be looked at.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fitted<'a> {
    pub model: &'a RobotModel,
    pub parameters: &'a [CalibratedParameter],
    /// Covariance of the coefficients, column-major.
    pub covariance: &'a [f64],
    /// By what the covariance is to be multiplied, because filtered rows are not independent.
    pub bandwidth: f64,
    pub ranges: &'a [JointRange],
    pub options: &'a CalibrationOptions,
    pub unit_of_measurement: MeasurementUnit,
}

/// A quantity that is linear in the coefficients, with its standard deviation.
#[derive(Debug, Clone, Copy)]
pub(super) struct Estimated {
    pub value: f64,
    pub std: f64,
}

impl Estimated {
    /// Whether it is below zero by more than noise.
    pub(super) fn is_negative(self) -> bool {
        self.value < -BEYOND_NOISE * self.std
    }
}

impl std::fmt::Display for Estimated {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&with_deviation(self.value, self.std))
    }
}

impl Fitted<'_> {
    /// Σ gradient_k ζ_k over a run of coefficients.
    pub(super) fn estimated(&self, columns: Range<usize>, gradient: &[f64]) -> Estimated {
        let n = self.parameters.len();
        let pairs = || columns.clone().zip(gradient);
        let value = pairs().map(|(k, g)| g * self.parameters[k].value).sum();
        let variance: f64 = pairs()
            .flat_map(|(k, g)| pairs().map(move |(l, h)| (k, l, g * h)))
            .map(|(k, l, product)| product * self.covariance[k * n + l])
            .sum();
        Estimated { value, std: (self.bandwidth * variance.max(0.0)).sqrt() }
    }

    pub(super) fn value(&self, column: usize) -> Estimated {
        self.estimated(column..column + 1, &[1.0])
    }
}
