//! Errors of a recording beside a model that is fitted to it anew.

use crate::evidence::gram::dot;
use crate::evidence::linear::Cholesky;
use crate::recordings::rows::{Layout, RecordingRows};

/// Takes off errors on the rows of a recording, `[model][joint][row]`, what columns of the model explain of them by least squares,
/// where a joint's squared errors have a weight.
pub(crate) fn free(
    errors: &mut [Vec<Vec<f64>>],
    rows: &RecordingRows,
    layout: &Layout,
    columns: &[usize],
    weights: &[f64],
) {
    let n = columns.len();
    let (mut gram, mut right) = (vec![0.0; n * n], vec![vec![0.0; n]; errors.len()]);
    let series = series(rows, layout, columns);
    for (j, (series, weight)) in series.iter().zip(weights).enumerate() {
        for (a, x) in series {
            series.iter().for_each(|(b, y)| gram[b * n + a] += weight * dot(x, y));
            right.iter_mut().zip(&*errors).for_each(|(right, of)| right[*a] += weight * dot(x, &of[j]));
        }
    }
    let gram = Cholesky::new(&gram, n);
    for (errors, right) in errors.iter_mut().zip(&right) {
        let coefficients = gram.solve(right);
        for (errors, series) in errors.iter_mut().zip(&series) {
            for (k, x) in series {
                errors.iter_mut().zip(*x).for_each(|(e, value)| *e -= coefficients[*k] * value);
            }
        }
    }
}

/// The columns of each joint beside their places among some.
pub(super) fn series<'r>(
    rows: &'r RecordingRows,
    layout: &Layout,
    columns: &[usize],
) -> Vec<Vec<(usize, &'r [f64])>> {
    let place = |column: &usize| columns.iter().position(|c| c == column);
    let of_joint = rows.joints.iter().zip(&layout.rows).map(|(joint, row)| {
        let own = row.iter().enumerate();
        own.filter_map(|(k, column)| Some((place(column)?, joint.column(k)))).collect()
    });
    of_joint.collect()
}
