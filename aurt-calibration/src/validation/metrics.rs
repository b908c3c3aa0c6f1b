use serde::{Deserialize, Serialize};

/// How well a prediction ŷ meets a measurement y, for each joint.
///
/// With e = y − ŷ over M samples: MSE = Σ e²/M; NMSE = MSE / mean|y|, the paper's normalisation (so it has the
/// measurement's unit); NRMSE = √(Σ e² / Σ y²). Entries are NaN (`null` in JSON) where no sample qualifies.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Metrics {
    /// Number of samples of each joint.
    pub samples: Vec<usize>,
    /// Mean squared error, unit of the measurement squared.
    pub mse: Vec<f64>,
    /// Mean squared error over mean absolute measurement (Table II of the paper).
    pub nmse: Vec<f64>,
    /// Root mean squared error over root mean squared measurement, as a fraction.
    pub nrmse: Vec<f64>,
}

/// Running sums of one joint's errors.
#[derive(Debug, Clone, Copy, Default)]
pub struct JointMetrics {
    samples: usize,
    squared_error: f64,
    absolute_measurement: f64,
    squared_measurement: f64,
}

impl JointMetrics {
    /// Takes in one sample.
    pub fn add(&mut self, measured: f64, predicted: f64) {
        self.samples += 1;
        self.squared_error += (measured - predicted).powi(2);
        self.absolute_measurement += measured.abs();
        self.squared_measurement += measured * measured;
    }

    /// Number of samples taken in.
    pub const fn samples(&self) -> usize {
        self.samples
    }

    /// Mean squared error.
    pub fn mse(&self) -> f64 {
        self.squared_error / self.samples as f64
    }

    /// Mean squared error over mean absolute measurement.
    pub fn nmse(&self) -> f64 {
        self.squared_error / self.absolute_measurement
    }

    /// √(Σ e² / Σ y²).
    pub fn nrmse(&self) -> f64 {
        (self.squared_error / self.squared_measurement).sqrt()
    }
}

impl FromIterator<JointMetrics> for Metrics {
    fn from_iter<I: IntoIterator<Item = JointMetrics>>(joints: I) -> Self {
        let mut metrics = Self::default();
        for joint in joints {
            metrics.samples.push(joint.samples());
            metrics.mse.push(joint.mse());
            metrics.nmse.push(joint.nmse());
            metrics.nrmse.push(joint.nrmse());
        }
        metrics
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_paper_s_normalisation_is_by_the_mean_amplitude() {
        let mut joint = JointMetrics::default();
        joint.add(2.0, 1.0);
        joint.add(-4.0, -4.0);
        let metrics: Metrics = [joint].into_iter().collect();
        assert_eq!(metrics.mse, [0.5]);
        assert_eq!(metrics.nmse, [0.5 / 3.0]);
        assert_eq!(metrics.nrmse, [(1.0_f64 / 20.0).sqrt()]);
    }
}
