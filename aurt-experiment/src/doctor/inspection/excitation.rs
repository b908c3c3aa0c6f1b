//! Which coefficients of a model a motion can determine.

use aurt_calibration::{System, condition_number};
use aurt_rbd::{Elimination, eliminate};

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
    let done = eliminate(&columns, 0..n, 1e-12, PRACTICAL_ZERO);
    let kept = &done.kept;
    let mut partners: Vec<Vec<usize>> = vec![Vec::new(); n];
    for (k, factors) in &done.dependent {
        let largest = factors.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
        let matters = kept.iter().zip(factors).filter(|(_, f)| f.abs() > DUST * largest);
        let group: Vec<usize> = matters.map(|(k, _)| *k).chain([*k]).collect();
        for member in &group {
            partners[*member].extend(group.iter().filter(|g| *g != member));
        }
    }
    let variances = variances(&done);
    let coefficients = (0..n)
        .map(|k| {
            let place = kept.iter().position(|c| *c == k);
            if place.is_none() && done.dependent.iter().all(|(dependent, _)| *dependent != k) {
                return Excitation::Silent;
            }
            if !partners[k].is_empty() {
                let mut with = partners[k].clone();
                with.sort_unstable();
                with.dedup();
                return Excitation::Combined(with);
            }
            Excitation::Own(place.map_or(0.0, |p| 1.0 / variances[p].sqrt()))
        })
        .collect();
    Excited { coefficients, rank: kept.len(), condition_number: condition(&done.triangle) }
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

/// Variances of the coefficients of unit-length columns: the squared lengths of the rows of R⁻¹.
fn variances(done: &Elimination) -> Vec<f64> {
    let mut variances = vec![0.0; done.kept.len()];
    for k in 0..done.kept.len() {
        let mut unit = vec![0.0; k + 1];
        unit[k] = 1.0;
        variances.iter_mut().zip(done.solve(unit)).for_each(|(variance, x)| *variance += x * x);
    }
    variances
}

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
