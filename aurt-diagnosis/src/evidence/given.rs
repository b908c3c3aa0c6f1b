//! The errors of a given model's coefficients.
//!
//! A model that is not refitted errs by X δ, where δ has the covariance P of its own calibration. The model lacks nothing for
//! that: the mean square of residuals is larger by xᵀPx, and coefficients γ of columns Z that are fitted beside
//! the model take up A δ, with A = (ZᵀWZ)⁻¹ZᵀWX, so that their covariance is larger by A P Aᵀ
//! ([`beside_given`](crate::evidence::deviations::beside_given)).

use aurt_calibration::Calibration;

use crate::evidence::gram::dot;
use crate::recordings::rows::{JointRows, Layout, RecordingRows};

/// The covariance P of a given model's coefficients, n × n, which are the first columns of every model that extends it.
#[derive(Debug, Clone)]
pub(crate) struct GivenCovariance {
    pub(crate) n: usize,
    pub(crate) matrix: Vec<f64>,
}

impl GivenCovariance {
    /// The covariance that a calibration states, if it does. Coefficients that were not excited are taken as exact.
    pub(crate) fn of(calibration: &Calibration) -> Option<Self> {
        let matrix = calibration.covariance_matrix()?;
        let known = matrix.into_iter().map(|v| if v.is_finite() { v } else { 0.0 }).collect();
        Some(Self { n: calibration.parameters.len(), matrix: known })
    }

    /// Sum of xᵀPx over the rows of a joint that has these `columns` of the model.
    pub(crate) fn sum_of_squares(&self, joint: &JointRows, columns: &[usize]) -> f64 {
        let own = || columns.iter().enumerate().filter(|(_, column)| **column < self.n);
        let of_pair = |((a, of_a), (b, of_b)): ((usize, &usize), (usize, &usize))| {
            let covariance = self.matrix[of_a * self.n + of_b];
            if covariance == 0.0 { 0.0 } else { covariance * dot(joint.column(a), joint.column(b)) }
        };
        own().flat_map(|a| own().map(move |b| (a, b))).map(of_pair).sum::<f64>().max(0.0)
    }

    /// The root of the mean of xᵀPx of each joint over the rows that count.
    pub(crate) fn rms(&self, recordings: &[RecordingRows], layout: &Layout) -> Vec<f64> {
        let of_joint = |(j, columns): (usize, &Vec<usize>)| {
            let joints = || recordings.iter().map(|r| &r.joints[j]);
            let counted: f64 = joints().map(|joint| joint.counted(0, joint.measurement.len())).sum();
            (joints().map(|joint| self.sum_of_squares(joint, columns)).sum::<f64>() / counted.max(1.0)).sqrt()
        };
        layout.rows.iter().enumerate().map(of_joint).collect()
    }
}
