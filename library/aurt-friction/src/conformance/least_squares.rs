//! A small least-squares solver, for checks that parameters come back from the data that they made.

/// The coefficients x that minimise |Σ_k x_k column_k − y|, or nothing where a column depends on the others (its
/// part that is new is smaller than 1e-9 of it).
///
/// Modified Gram–Schmidt, each column orthogonalised twice.
#[must_use]
pub fn solve(columns: &[Vec<f64>], y: &[f64]) -> Option<Vec<f64>> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let count = columns.len();
    let mut basis: Vec<Vec<f64>> = Vec::with_capacity(count);
    let mut triangle = vec![vec![0.0; count]; count];
    for (k, column) in columns.iter().enumerate() {
        let norm = dot(column, column).sqrt();
        let mut rest = column.clone();
        for _ in 0..2 {
            for (i, q) in basis.iter().enumerate() {
                let share = dot(q, &rest);
                triangle[i][k] += share;
                rest.iter_mut().zip(q).for_each(|(r, q)| *r -= share * q);
            }
        }
        let new = dot(&rest, &rest).sqrt();
        if new <= 1e-9 * norm {
            return None;
        }
        rest.iter_mut().for_each(|r| *r /= new);
        triangle[k][k] = new;
        basis.push(rest);
    }
    let mut rest = y.to_vec();
    let mut x = vec![0.0; count];
    for (k, q) in basis.iter().enumerate() {
        x[k] = dot(q, &rest);
        let share = x[k];
        rest.iter_mut().zip(q).for_each(|(r, q)| *r -= share * q);
    }
    for k in (0..count).rev() {
        for i in k + 1..count {
            x[k] -= triangle[k][i] * x[i];
        }
        x[k] /= triangle[k][k];
    }
    Some(x)
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_line_and_a_dependent_column() {
        let ones = vec![1.0; 4];
        let ramp = vec![0.0, 1.0, 2.0, 3.0];
        let x = super::solve(&[ones.clone(), ramp.clone()], &[1.0, 3.0, 5.0, 7.0]).unwrap();
        assert!((x[0] - 1.0).abs() < 1e-12 && (x[1] - 2.0).abs() < 1e-12, "{x:?}");
        assert!(super::solve(&[ones, ramp.clone(), ramp], &[0.0; 4]).is_none());
    }
}
