use nalgebra::{DMatrix, DVector};

/// Normal equations of a weighted least squares whose rows are sparse by joint.
#[derive(Debug, Clone)]
pub struct Gram {
    matrix: DMatrix<f64>,
    right: DVector<f64>,
}

/// Share of the scaled unit diagonal that is added, so that columns that repeat others do no harm.
const RIDGE: f64 = 1e-11;

impl Gram {
    pub fn new(coefficients: usize) -> Self {
        Self { matrix: DMatrix::zeros(coefficients, coefficients), right: DVector::zeros(coefficients) }
    }

    /// Adds rows of one joint: entry k of `row` is the column of coefficient `coefficients[k]`.
    pub fn add<C: AsRef<[f64]>>(&mut self, coefficients: &[usize], row: &[C], measured: &[f64], weight: f64) {
        let dot = |a: &[f64], b: &[f64]| {
            let mut lanes = [0.0; 8];
            let (a8, a_rest) = a.as_chunks::<8>();
            let (b8, b_rest) = b.as_chunks::<8>();
            for (x, y) in a8.iter().zip(b8) {
                for (lane, (x, y)) in lanes.iter_mut().zip(x.iter().zip(y)) {
                    *lane += x * y;
                }
            }
            lanes.iter().sum::<f64>() + a_rest.iter().zip(b_rest).map(|(x, y)| x * y).sum::<f64>()
        };
        for (k, column) in coefficients.iter().zip(row) {
            self.right[*k] += weight * dot(column.as_ref(), measured);
            for (l, other) in coefficients.iter().zip(row).take_while(|(l, _)| *l <= k) {
                let product = weight * dot(column.as_ref(), other.as_ref());
                self.matrix[(*k, *l)] += product;
                if k != l {
                    self.matrix[(*l, *k)] += product;
                }
            }
        }
    }

    pub fn solve(&self) -> Vec<f64> {
        let n = self.right.len();
        let scale: Vec<f64> = (0..n)
            .map(|k| if self.matrix[(k, k)] > 0.0 { 1.0 / self.matrix[(k, k)].sqrt() } else { 0.0 })
            .collect();
        let scaled = DMatrix::from_fn(n, n, |r, c| {
            let entry = self.matrix[(r, c)] * scale[r] * scale[c];
            if r == c { if scale[r] > 0.0 { entry + RIDGE } else { 1.0 } } else { entry }
        });
        let right = DVector::from_fn(n, |k, _| self.right[k] * scale[k]);
        match scaled.cholesky() {
            Some(factor) => {
                let solution = factor.solve(&right);
                (0..n).map(|k| solution[k] * scale[k]).collect()
            }
            None => vec![0.0; n],
        }
    }
}

pub fn mean_square(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64
}
