//! Errors of a recording beside a model that is fitted to it anew.

use crate::evidence::gram::dot;
use crate::evidence::linear::Cholesky;
use crate::recordings::rows::{Layout, RecordingRows};

/// Least squares of a model's columns on the rows of one recording.
pub(crate) struct Refit<'a> {
    rows: &'a RecordingRows,
    /// Of each joint, the columns that it has: their places among those of the model, and among its own.
    places: Vec<Vec<[usize; 2]>>,
    weights: &'a [f64],
    gram: Cholesky,
    columns: usize,
}

impl<'a> Refit<'a> {
    /// Of the model with these columns, where a joint's squared errors have a weight.
    pub(crate) fn new(
        rows: &'a RecordingRows,
        layout: &Layout,
        columns: &[usize],
        weights: &'a [f64],
    ) -> Self {
        let of_joint = |row: &Vec<usize>| {
            let place = |(own, column)| Some([columns.iter().position(|c| c == column)?, own]);
            row.iter().enumerate().filter_map(place).collect()
        };
        let places: Vec<Vec<[usize; 2]>> = layout.rows.iter().map(of_joint).collect();
        let n = columns.len();
        let mut gram = vec![0.0; n * n];
        for ((joint, places), weight) in rows.joints.iter().zip(&places).zip(weights) {
            for [a, own_a] in places {
                for [b, own_b] in places {
                    gram[b * n + a] += weight * dot(joint.column(*own_a), joint.column(*own_b));
                }
            }
        }
        Self { rows, places, weights, gram: Cholesky::new(&gram, n), columns: n }
    }

    /// Takes off errors, `[joint][row]`, what the model explains of them.
    pub(crate) fn free(&self, errors: &mut [Vec<f64>]) {
        let mut right = vec![0.0; self.columns];
        for (((joint, places), weight), errors) in
            self.rows.joints.iter().zip(&self.places).zip(self.weights).zip(&*errors)
        {
            places.iter().for_each(|[k, own]| right[*k] += weight * dot(joint.column(*own), errors));
        }
        let coefficients = self.gram.solve(&right);
        for ((joint, places), errors) in self.rows.joints.iter().zip(&self.places).zip(errors) {
            for [k, own] in places {
                let column = joint.column(*own).iter();
                errors.iter_mut().zip(column).for_each(|(e, value)| *e -= coefficients[*k] * value);
            }
        }
    }
}
