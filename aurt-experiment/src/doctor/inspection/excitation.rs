//! Which coefficients of a model a motion can determine.

use aurt_calibration::{System, condition_number};

/// A column counts as dependent on others if less than this share of its length is its own. The standard deviation
/// of its coefficient is then at least a thousand times what it would be alone: with a thousand rows, and noise of
/// some percent of the signal, that is all of its value.
const PRACTICAL_ZERO: f64 = 1e-3;
/// Columns that take part in a combination with less than this share of the largest do not matter to it.
const DUST: f64 = 1e-2;

#[derive(Debug, Clone, PartialEq)]
pub enum Excitation {
    /// It is determined. The share of its column that no combination of the others can imitate, (0, 1].
    Own(f64),
    /// Only a combination with these other coefficients is determined, by their indices.
    Combined(Vec<usize>),
    /// The motion does not need it: its column is zero.
    Silent,
}

/// What a motion says of a model's coefficients.
#[derive(Debug, Clone, PartialEq)]
pub struct Excited {
    pub coefficients: Vec<Excitation>,
    /// Number of combinations that are determined: the rank.
    pub rank: usize,
    /// Ratio of the largest to the smallest singular value of those columns that are independent, scaled to equal
    /// length.
    pub condition_number: f64,
}

/// Judges the observation matrix of a system.
///
/// Columns are scaled to unit length and orthogonalised from left to right; a dependent one is expressed by those
/// before it, and then neither it nor these are determined by themselves.
pub fn judge(system: &System) -> Excited {
    let columns = stacked(system);
    let n = columns.len();
    let lengths: Vec<f64> = columns.iter().map(|c| dot(c, c).sqrt()).collect();
    let longest = lengths.iter().copied().fold(0.0, f64::max);
    let mut kept: Vec<usize> = Vec::new();
    let mut q: Vec<Vec<f64>> = Vec::new();
    let mut r: Vec<Vec<f64>> = Vec::new();
    let mut partners: Vec<Vec<usize>> = vec![Vec::new(); n];
    let mut silent = vec![false; n];
    for k in 0..n {
        if lengths[k] <= 1e-12 * longest || lengths[k] == 0.0 {
            silent[k] = true;
            continue;
        }
        let mut rest: Vec<f64> = columns[k].iter().map(|v| v / lengths[k]).collect();
        let mut row = vec![0.0; q.len()];
        for _ in 0..2 {
            for (direction, share) in q.iter().zip(&mut row) {
                let projection = dot(direction, &rest);
                *share += projection;
                rest.iter_mut().zip(direction).for_each(|(v, d)| *v -= projection * d);
            }
        }
        let own = dot(&rest, &rest).sqrt();
        if own > PRACTICAL_ZERO {
            rest.iter_mut().for_each(|v| *v /= own);
            row.push(own);
            q.push(rest);
            r.push(row);
            kept.push(k);
        } else {
            let factors = solve_triangle(&r, row);
            let largest = factors.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
            let group: Vec<usize> = kept
                .iter()
                .zip(&factors)
                .filter(|(_, f)| f.abs() > DUST * largest)
                .map(|(k, _)| *k)
                .chain([k])
                .collect();
            for member in &group {
                partners[*member].extend(group.iter().filter(|g| *g != member));
            }
        }
    }
    let inverse = inverse_rows(&r);
    let coefficients = (0..n)
        .map(|k| {
            if silent[k] {
                return Excitation::Silent;
            }
            if !partners[k].is_empty() {
                let mut with = partners[k].clone();
                with.sort_unstable();
                with.dedup();
                return Excitation::Combined(with);
            }
            let place = kept.iter().position(|c| *c == k);
            // The variance of a coefficient of unit-length columns is the squared length of its row of R⁻¹.
            Excitation::Own(place.map_or(0.0, |p| 1.0 / dot(&inverse[p], &inverse[p]).sqrt()))
        })
        .collect();
    Excited { coefficients, rank: kept.len(), condition_number: condition(&r) }
}

/// The columns of the observation matrix as far as least squares can see them: the joints' triangles, one below
/// the other.
fn stacked(system: &System) -> Vec<Vec<f64>> {
    let mut columns = vec![Vec::new(); system.coefficients()];
    for factor in system.factors() {
        let size = factor.columns().len() + 1;
        let triangle = factor.triangle();
        let rows = columns.first().map_or(0, Vec::len);
        for column in &mut columns {
            column.resize(rows + size, 0.0);
        }
        for (k, column) in factor.columns().iter().enumerate() {
            columns[*column][rows..=rows + k].copy_from_slice(&triangle[k * size..=k * size + k]);
        }
    }
    columns
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// x with R x = b, R by columns.
fn solve_triangle(r: &[Vec<f64>], mut b: Vec<f64>) -> Vec<f64> {
    for row in (0..b.len()).rev() {
        b[row] /= r[row][row];
        for above in 0..row {
            b[above] -= r[row][above] * b[row];
        }
    }
    b
}

/// R⁻¹ by rows, R by columns.
fn inverse_rows(r: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let n = r.len();
    let mut rows = vec![vec![0.0; n]; n];
    for k in 0..n {
        let mut unit = vec![0.0; k + 1];
        unit[k] = 1.0;
        for (row, value) in solve_triangle(r, unit).into_iter().enumerate() {
            rows[row][k] = value;
        }
    }
    rows
}

/// The condition number of R, by columns.
fn condition(r: &[Vec<f64>]) -> f64 {
    let n = r.len();
    let whole = r.iter().flat_map(|column| column.iter().copied().chain(std::iter::repeat(0.0)).take(n));
    condition_number(&whole.collect::<Vec<f64>>(), n)
}

#[cfg(test)]
mod tests {
    use aurt_calibration::JointFactor;

    use super::*;

    fn system(columns: &[Vec<f64>]) -> System {
        let mut factor = JointFactor::new((0..columns.len()).collect());
        let zeros = vec![0.0; columns[0].len()];
        factor.push(|k| &columns[k], &zeros, |_| true);
        System::new(columns.len(), vec![factor])
    }

    #[test]
    fn dependent_columns_are_determined_together_only() {
        let wave = |f: f64| -> Vec<f64> { (0..500).map(|k| (f64::from(k) * f).sin()).collect() };
        let (a, b) = (wave(0.31), wave(0.07));
        let sum: Vec<f64> = a.iter().zip(&b).map(|(a, b)| 2.0 * a - b).collect();
        let excited = judge(&system(&[a, wave(0.9), b, sum, vec![0.0; 500]]));
        assert_eq!(excited.rank, 3);
        assert_eq!(excited.coefficients[0], Excitation::Combined(vec![2, 3]));
        assert_eq!(excited.coefficients[3], Excitation::Combined(vec![0, 2]));
        assert_eq!(excited.coefficients[4], Excitation::Silent);
        assert!(matches!(excited.coefficients[1], Excitation::Own(share) if share > 0.99));
    }

    #[test]
    fn nearly_parallel_columns_have_little_of_their_own() {
        let a: Vec<f64> = (0..400).map(|k| (f64::from(k) * 0.11).sin()).collect();
        let c: Vec<f64> = (0..400).map(|k| (f64::from(k) * 0.11).cos()).collect();
        let near: Vec<f64> = a.iter().zip(&c).map(|(a, c)| a + 0.01 * c).collect();
        let excited = judge(&system(&[a, near]));
        let Excitation::Own(share) = excited.coefficients[0] else { panic!("{excited:?}") };
        assert!((share - 0.01).abs() < 2e-4, "{share}");
        // Two unit vectors with an angle of 0.01 between them: √((1 + cos) / (1 − cos)) ≈ 2 / 0.01.
        assert!((excited.condition_number / 200.0 - 1.0).abs() < 0.02, "{}", excited.condition_number);
    }
}
