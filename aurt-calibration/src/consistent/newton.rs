//! Newton's method on the convex program, with the barrier at one weight.

use nalgebra::{DMatrix, DVector, Matrix4};

use super::program::{Program, ROUNDING};
use crate::linear::{Cholesky, gram};
use crate::physical::{Standard, adjoint, metric, pseudo_inertia};

/// Share of the way to the nearest bound that a step along the path may take.
const KEPT_AWAY: f64 = 0.7;

/// Gradient and second derivative's root of the barrier.
pub(super) struct Local {
    gradient: DVector<f64>,
    root: DMatrix<f64>,
}

impl Program {
    pub(super) fn local(&self, y: &DVector<f64>, inverse: &[Matrix4<f64>], weight: f64) -> Option<Local> {
        let n = self.variables();
        let first = 10 * self.bodies.len();
        let mut gradient = DVector::zeros(n);
        let mut root = DMatrix::zeros(first + self.positive.len(), n);
        for (k, ((body, standard), prior)) in
            self.bodies.iter().zip(self.standard(y)).zip(inverse).enumerate()
        {
            let more = body.emphasis(weight);
            let p = pseudo_inertia(&standard.data.0[0]);
            // B = L⁻¹ of P = L Lᵀ, so that BᵀB = P⁻¹ also where P is nearly singular.
            let b = p.cholesky()?.l().solve_lower_triangular(&Matrix4::identity())?;
            let own = b.transpose() * b;
            gradient.gemv_tr(more, &body.of, &adjoint(&(prior - own)), 1.0);
            root.rows_mut(10 * k, 10).gemm(1.0, &(metric(&b) * more.sqrt()), &body.of, 0.0);
        }
        for (k, p) in self.positive.iter().enumerate() {
            let amount = p.at + p.of.dot(y);
            if amount <= 0.0 {
                return None;
            }
            gradient.axpy(-1.0 / amount, &p.of, 1.0);
            root.row_mut(first + k).copy_from(&(p.of.transpose() / amount));
        }
        Some(Local { gradient, root })
    }

    /// Where the central path leads, to first order, at a smaller weight: H dy = −∇φ dμ with H at the weight before. Near
    /// a bound a distance is proportional to the weight, and this step reaches it, where Newton's from there would overshoot.
    pub(super) fn predicted(
        &self,
        y: &DVector<f64>,
        local: &Local,
        weight: f64,
        next: f64,
    ) -> Option<DVector<f64>> {
        let direction = self.direction(local, &(&local.gradient * (next - weight)), weight)?;
        let nearest = self.shrinking(y, &direction)?.iter().fold(0.0_f64, |a, v| a.min(*v));
        // What is too near a bound afterwards takes many steps to come away from it.
        let length = if nearest < 0.0 { (-KEPT_AWAY / nearest).min(1.0) } else { 1.0 };
        let there = y + length * direction;
        self.is_inside(&there).then_some(there)
    }

    /// The relative rates at which what has to be positive changes along a direction: eigenvalues of L⁻¹ dP L⁻ᵀ for
    /// P = L Lᵀ, four for each body, and dp/p.
    fn shrinking(&self, y: &DVector<f64>, direction: &DVector<f64>) -> Option<Vec<f64>> {
        let mut rates = Vec::with_capacity(4 * self.bodies.len() + self.positive.len());
        for (body, standard) in self.bodies.iter().zip(self.standard(y)) {
            let step =
                pseudo_inertia(&Standard::from_iterator((&body.of * direction).iter().copied()).data.0[0]);
            let l = pseudo_inertia(&standard.data.0[0]).cholesky()?.l();
            let half = l.solve_lower_triangular(&step)?;
            let whole = l.solve_lower_triangular(&half.transpose())?;
            if !whole.iter().all(|v| v.is_finite()) {
                return None;
            }
            rates.extend(whole.symmetric_eigenvalues().iter().copied());
        }
        rates.extend(self.positive.iter().map(|p| p.of.dot(direction) / (p.at + p.of.dot(y))));
        Some(rates)
    }

    /// Newton steps at one weight of the barrier; Newton's decrement, squared, where they end near the centre.
    pub(super) fn centre(
        &self,
        y: &mut DVector<f64>,
        local: &mut Local,
        inverse: &[Matrix4<f64>],
        weight: f64,
        enough: f64,
        (steps, most_steps): (&mut usize, usize),
    ) -> Option<f64> {
        while *steps < most_steps {
            let mut gradient = &local.gradient * weight;
            let mut seen = gradient.rows_mut(self.free, self.seen);
            seen.axpy(1.0 / self.scale, &y.rows(self.free, self.seen), 1.0);
            let direction = self.direction(local, &gradient, weight)?;
            let decrement = -gradient.dot(&direction);
            // Near the centre, or what is left to gain is rounding.
            if decrement <= (enough * weight).max(ROUNDING.powi(2) * self.loss(y)) {
                return Some(decrement);
            }
            let length = self.length(y, &direction, weight, -decrement)?;
            y.axpy(length, &direction, 1.0);
            *steps += 1;
            *local = self.local(y, inverse, weight)?;
        }
        None
    }

    /// How far to go along a direction in which the objective begins with the slope given: to where it is least. With the
    /// eigenvalues λ of L⁻¹ dP L⁻ᵀ, P = L Lᵀ, −log det(P + t dP) is −Σ log(1 + t λ), and the rest a parabola; so the slope is
    /// known everywhere, and its zero is bracketed.
    fn length(&self, y: &DVector<f64>, direction: &DVector<f64>, weight: f64, slope: f64) -> Option<f64> {
        let curvature = direction.rows(self.free, self.seen).norm_squared() / self.scale;
        // Four eigenvalues of each body come first.
        let weight_of = |k: usize| weight * self.bodies.get(k / 4).map_or(1.0, |body| body.emphasis(weight));
        let logarithms: Vec<(f64, f64)> =
            self.shrinking(y, direction)?.into_iter().enumerate().map(|(k, v)| (weight_of(k), v)).collect();
        // The slope at t less that at 0: ct + Σ w λ² t / (1 + t λ).
        let slope_at = |t: f64| {
            let bent: f64 = logarithms.iter().map(|(w, v)| w * v * v * t / (1.0 + t * v)).sum();
            slope + curvature * t + bent
        };
        let least = logarithms.iter().fold(0.0_f64, |a, (_, v)| a.min(*v));
        let (mut low, mut high) = (0.0, if least < 0.0 { -KEPT_AWAY / least } else { f64::INFINITY });
        if high.is_finite() && slope_at(high) < 0.0 {
            return Some(high);
        }
        if high.is_infinite() {
            high = 1.0;
            while slope_at(high) < 0.0 && high < 1e12 {
                low = high;
                high *= 2.0;
            }
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            *(if slope_at(middle) < 0.0 { &mut low } else { &mut high }) = middle;
        }
        (low > 0.0).then_some(low)
    }

    /// −H⁻¹ g, from H = diag(0, 1/s) + μ RᵀR with its diagonal scaled to one.
    fn direction(&self, local: &Local, gradient: &DVector<f64>, weight: f64) -> Option<DVector<f64>> {
        let n = self.variables();
        let mut hessian = gram(&local.root) * weight;
        for k in self.free..n {
            hessian[(k, k)] += 1.0 / self.scale;
        }
        let scale = hessian.diagonal().map(|d| if d > 0.0 { d.sqrt().recip() } else { 1.0 });
        for c in 0..n {
            for r in 0..n {
                hessian[(r, c)] *= scale[r] * scale[c];
            }
        }
        let factor = factorised(hessian)?;
        let right = -gradient.component_mul(&scale);
        Some(factor.solve(&right).component_mul(&scale))
    }
}

/// The Cholesky factor; of a matrix that is singular to rounding, that of one nearby.
fn factorised(matrix: DMatrix<f64>) -> Option<Cholesky> {
    let mut ridge = 0.0;
    loop {
        let mut attempt = matrix.clone();
        (0..attempt.nrows()).for_each(|k| attempt[(k, k)] += ridge);
        if let Some(found) = Cholesky::of(&attempt) {
            return Some(found);
        }
        if ridge > 1e-6 || !matrix.iter().all(|v| v.is_finite()) {
            return None;
        }
        ridge = if ridge == 0.0 { 1e-15 } else { 10.0 * ridge };
    }
}
