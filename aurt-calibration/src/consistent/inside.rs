//! Coefficients that make friction brake everywhere: a point from which a barrier can start.

use nalgebra::DVector;

/// Corrections of all rows after which no point is taken to exist.
const MOST_ROUNDS: usize = 20_000;

/// Moves `begin` to where all rows are positive, `estimated` coefficients alone. Rows without such coefficients go, and so
/// do those of joints for which no point is found; these are returned.
///
/// Rows that fall short are corrected one after the other, each by the shortest way, in coefficients that are scaled by
/// their columns (Agmon 1954, Motzkin and Schoenberg 1954); where there is a point that satisfies all by a margin, this
/// ends.
pub(super) fn inside(
    rows: &mut Vec<(Option<usize>, DVector<f64>)>,
    estimated: &[bool],
    begin: &mut DVector<f64>,
) -> Vec<usize> {
    for (_, row) in rows.iter_mut() {
        row.iter_mut().zip(estimated).filter(|(_, e)| !**e).for_each(|(v, _)| *v = 0.0);
    }
    rows.retain(|(_, row)| row.iter().any(|v| *v != 0.0));
    let mut undecided = Vec::new();
    loop {
        let Some(short) = corrected(rows, begin) else { return undecided };
        match rows[short].0 {
            Some(joint) => {
                undecided.push(joint);
                rows.retain(|(own, _)| *own != Some(joint));
            }
            // A single coefficient can always be positive.
            None => {
                rows.remove(short);
            }
        }
    }
}

/// A row that cannot be made positive together with the others, if there is one.
fn corrected(rows: &[(Option<usize>, DVector<f64>)], begin: &mut DVector<f64>) -> Option<usize> {
    let n = begin.len();
    let mut scale = DVector::zeros(n);
    for (_, row) in rows {
        scale.zip_apply(row, |s: &mut f64, v| *s = s.max(v.abs()));
    }
    scale.apply(|s| *s = if *s > 0.0 { 1.0 / *s } else { 1.0 });
    let scaled: Vec<DVector<f64>> = rows
        .iter()
        .map(|(_, row)| {
            let row = row.component_mul(&scale);
            let length = row.norm();
            row / length
        })
        .collect();
    let mut point = begin.component_div(&scale);
    let size = scaled.iter().fold(0.0_f64, |a, row| a.max(row.dot(&point).abs()));
    let margin = if size > 0.0 { 1e-3 * size } else { 1e-3 };
    let mut worst = None;
    for _ in 0..MOST_ROUNDS {
        worst = None;
        for (k, row) in scaled.iter().enumerate() {
            let amount = row.dot(&point);
            if amount < margin {
                worst = Some(k);
                point.axpy(2.0 * margin - amount, row, 1.0);
            }
        }
        if worst.is_none() {
            *begin = point.component_mul(&scale);
            return None;
        }
    }
    worst
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_found_where_there_is_one_and_missed_where_there_is_none() {
        // c + v t > 0 at three speeds, from values that violate all.
        let row = |speed: f64| (Some(0), DVector::from_vec(vec![1.0, speed, 0.0]));
        let mut rows = vec![row(0.01), row(1.0), row(2.0), (None, DVector::from_vec(vec![0.0, 0.0, 3.0]))];
        let mut begin = DVector::from_vec(vec![1.0, -5.0, -1.0]);
        assert_eq!(inside(&mut rows, &[true; 3], &mut begin), Vec::<usize>::new());
        assert!(rows.iter().all(|(_, r)| r.dot(&begin) > 0.0), "{begin}");
        // A column that changes its sign cannot be positive on either side.
        let mut rows = vec![row(1.0), (Some(1), DVector::from_vec(vec![0.0, 0.0, 1.0]))];
        rows.push((Some(1), DVector::from_vec(vec![0.0, 0.0, -1.0])));
        let mut begin = DVector::from_vec(vec![-1.0, 0.0, 0.0]);
        assert_eq!(inside(&mut rows, &[true; 3], &mut begin), [1]);
        assert_eq!(rows.len(), 1);
    }
}
