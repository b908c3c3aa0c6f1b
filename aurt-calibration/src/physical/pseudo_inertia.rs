//! Pseudo-inertia: ten standard parameters as a symmetric 4 × 4 matrix.

use std::sync::LazyLock;

use nalgebra::{Matrix4, SMatrix, SVector};

/// Ten standard parameters {XX XY XZ YY YZ ZZ mX mY mZ m}.
pub(crate) type Standard = SVector<f64, 10>;

/// A body's pseudo-inertia ∫ (x, 1)(x, 1)ᵀ dm: positive definite if and only if some distribution of positive mass
/// has these parameters, which holds if the mass is positive and the principal moments about the centre of mass
/// satisfy the triangle inequalities (Wensing, Kim, Slotine, *Linear matrix inequalities for physically consistent
/// inertial parameter identification*, IEEE RA-L 3(1), 2018).
pub(crate) fn pseudo_inertia(p: &[f64; 10]) -> Matrix4<f64> {
    let [xx, xy, xz, yy, yz, zz, mx, my, mz, m] = *p;
    let half = 0.5 * (xx + yy + zz);
    // Off the diagonal the tensor of inertia is −∫xy dm.
    Matrix4::from_row_slice(&[
        half - xx,
        -xy,
        -xz,
        mx, //
        -xy,
        half - yy,
        -yz,
        my, //
        -xz,
        -yz,
        half - zz,
        mz, //
        mx,
        my,
        mz,
        m,
    ])
}

/// ∂P/∂π_i, the pseudo-inertias of the ten unit vectors.
static UNITS: LazyLock<[Matrix4<f64>; 10]> = LazyLock::new(|| {
    std::array::from_fn(|i| {
        let mut unit = [0.0; 10];
        unit[i] = 1.0;
        pseudo_inertia(&unit)
    })
});

/// tr(M ∂P/∂π_i) for the ten parameters: the adjoint of π ↦ P.
pub(crate) fn adjoint(matrix: &Matrix4<f64>) -> Standard {
    Standard::from_fn(|i, _| matrix.dot(&UNITS[i]))
}

/// G with GᵀG = [tr(A ∂P/∂π_i A ∂P/∂π_k)]_ik for A = BᵀB: row for row the entries of B ∂P/∂π_i Bᵀ, those off the
/// diagonal times √2.
pub(crate) fn metric(b: &Matrix4<f64>) -> SMatrix<f64, 10, 10> {
    let mut g = SMatrix::<f64, 10, 10>::zeros();
    for (i, unit) in UNITS.iter().enumerate() {
        let seen = b * unit * b.transpose();
        let mut row = 0;
        for r in 0..4 {
            g[(row, i)] = seen[(r, r)];
            row += 1;
            for c in r + 1..4 {
                g[(row, i)] = std::f64::consts::SQRT_2 * seen[(r, c)];
                row += 1;
            }
        }
    }
    g
}

pub(crate) fn standard_of(p: &Matrix4<f64>) -> Standard {
    let (x, y, z) = (p[(0, 0)], p[(1, 1)], p[(2, 2)]);
    Standard::from_row_slice(&[
        y + z,
        -p[(0, 1)],
        -p[(0, 2)],
        x + z,
        -p[(1, 2)],
        x + y,
        p[(0, 3)],
        p[(1, 3)],
        p[(2, 3)],
        p[(3, 3)],
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_adjoint_is_that_of_the_map() {
        let p = [0.3, -0.01, 0.02, 0.4, 0.03, 0.25, 0.1, -0.2, 0.3, 2.0];
        let m = Matrix4::from_fn(|r, c| f64::from(u8::try_from(3 * r.min(c) + r.max(c)).unwrap()));
        let left = m.dot(&pseudo_inertia(&p));
        let right = adjoint(&m).dot(&Standard::from_row_slice(&p));
        assert!((left - right).abs() < 1e-12, "{left} {right}");
        assert!((standard_of(&pseudo_inertia(&p)) - Standard::from_row_slice(&p)).norm() < 1e-14);
    }

    #[test]
    fn the_metric_is_the_second_derivative_of_the_logarithm_of_the_determinant() {
        let p = [0.5, -0.01, 0.02, 0.6, 0.03, 0.45, 0.1, -0.2, 0.3, 2.0];
        let inverse = pseudo_inertia(&p).try_inverse().unwrap();
        let b = inverse.cholesky().unwrap().l().transpose();
        let g = metric(&b);
        let hessian = g.transpose() * g;
        let gradient = |p: &[f64; 10]| -adjoint(&pseudo_inertia(p).try_inverse().unwrap());
        for k in 0..10 {
            let (mut above, mut below) = (p, p);
            above[k] += 1e-6;
            below[k] -= 1e-6;
            let difference = (gradient(&above) - gradient(&below)) / 2e-6;
            let error = (difference - hessian.column(k)).norm() / difference.norm();
            assert!(error < 1e-6, "{k}: {error:e}");
        }
    }
}
