//! The convex program behind consistent estimates, and its central path.

use nalgebra::{DMatrix, DVector, Matrix4};

use crate::physical::{Standard, pseudo_inertia};

/// A point is centred when Newton's decrement, squared and over the weight of the barrier, is below this on the way,
/// and below the second at the end.
const CENTRED: [f64; 2] = [0.3, 1e-6];
/// The barrier's weight falls by this factor from centre to centre.
const FALL: f64 = 0.1;
/// Newton steps after which a search is given up.
const MOST_STEPS: usize = 600;
/// Share of the loss itself below which a distance from the optimum is rounding.
pub(super) const ROUNDING: f64 = 1e-9;

/// A body whose ten standard parameters are affine in the variables.
#[derive(Debug, Clone)]
pub(crate) struct BodyMap {
    /// 10 × n.
    pub of: DMatrix<f64>,
    /// Its parameters where all variables are zero.
    pub at: Standard,
    /// Its pseudo-inertia in the prior.
    pub prior: Matrix4<f64>,
    /// The weight of the pull towards it does not fall below this, in squared standard deviations; zero where the prior only
    /// decides what the data leave open.
    pub pull_weight: f64,
}

impl BodyMap {
    /// By how much its pull outweighs the barrier of what is positive.
    pub(super) fn emphasis(&self, weight: f64) -> f64 {
        (self.pull_weight / weight).max(1.0)
    }
}

/// A quantity, affine in the variables, that is positive.
#[derive(Debug, Clone)]
pub(crate) struct Positive {
    /// Its gradient.
    pub of: DVector<f64>,
    /// Its value where all variables are zero.
    pub at: f64,
}

/// min ½ ‖ξ‖²/s + μ (Σ pull(P_l) − Σ log p_k) over y = (v, ξ), for a fixed s and a μ that falls.
///
/// The pull is the entropic (Bregman) divergence tr(P₀⁻¹P) − log det(P₀⁻¹P) − 4 of pseudo-inertias, which is the same in all
/// coordinates (Lee, Wensing, Park, *Geometric robot dynamic identification: a convex programming approach*, IEEE T-RO 36(2),
/// 2020).
///
/// ξ are the data's variables: ξ = 0 explains them best, and a distance of one costs one standard deviation if the
/// rows are independent. v are those of which the data know nothing.
#[derive(Debug, Clone)]
pub(crate) struct Program {
    /// Number of variables v.
    pub free: usize,
    /// Number of variables ξ.
    pub seen: usize,
    /// By which the rows' noise exceeds that of independent rows.
    pub scale: f64,
    pub bodies: Vec<BodyMap>,
    pub positive: Vec<Positive>,
}

#[derive(Debug, Clone)]
pub(crate) struct Reached {
    /// y.
    pub at: DVector<f64>,
    /// ½ ‖ξ‖²/s.
    pub loss: f64,
    /// The optimum's loss is at most so much below, whether or not the search converged.
    pub within: f64,
    pub steps: usize,
    pub converged: bool,
    /// The last weight of the barrier.
    #[cfg_attr(not(test), expect(dead_code, reason = "the certificate of optimality in tests needs it"))]
    pub weight: f64,
}

impl Program {
    pub(super) fn variables(&self) -> usize {
        self.free + self.seen
    }

    pub(super) fn loss(&self, y: &DVector<f64>) -> f64 {
        0.5 * y.rows(self.free, self.seen).norm_squared() / self.scale
    }

    pub(crate) fn standard(&self, y: &DVector<f64>) -> Vec<Standard> {
        self.bodies.iter().map(|b| b.at + Standard::from_iterator((&b.of * y).iter().copied())).collect()
    }

    /// Whether all bodies can exist and everything else is positive.
    pub(super) fn is_inside(&self, y: &DVector<f64>) -> bool {
        self.standard(y).iter().all(|s| pseudo_inertia(&s.data.0[0]).cholesky().is_some())
            && self.positive.iter().all(|p| p.at + p.of.dot(y) > 0.0)
    }

    /// Follows the central path from a point inside until the loss (with the pull, where that has a weight of its own) is
    /// within `tolerance` of the least that is possible, or no longer falls but by rounding; nothing if the point is not
    /// inside.
    ///
    pub(crate) fn solve(&self, start: DVector<f64>, tolerance: f64) -> Option<Reached> {
        self.solve_in(start, tolerance, MOST_STEPS)
    }

    fn solve_in(&self, start: DVector<f64>, tolerance: f64, most_steps: usize) -> Option<Reached> {
        let inverse: Vec<Matrix4<f64>> =
            self.bodies.iter().map(|b| b.prior.try_inverse()).collect::<Option<_>>()?;
        let mut y = start;
        let mut weight = (self.loss(&y) / self.corners()).max(tolerance / self.corners());
        let mut steps = 0;
        // No loss is below this: it is a sum of squares, and centres raise it.
        let mut least: f64 = 0.0;
        let mut before: Option<Reached> = None;
        loop {
            // Where rounding ends the path, the last centre is a machine all the same.
            let Some(mut local) = self.local(&y, &inverse, weight) else { return before };
            let expected = weight * self.reach(&y, &inverse);
            let last = expected <= tolerance.max(ROUNDING * self.loss(&y));
            let enough = CENTRED[usize::from(last)];
            let centred = self.centre(&mut y, &mut local, &inverse, weight, enough, (&mut steps, most_steps));
            let loss = self.loss(&y);
            if let Some(gap) = centred.and_then(|decrement| self.gap(&y, &inverse, weight, decrement)) {
                least = least.max(loss - gap);
            }
            let within = (loss - least).max(0.0);
            let converged = last && centred.is_some();
            let reached = Reached { at: y.clone(), loss, within, steps, converged, weight };
            if last || steps >= most_steps {
                return Some(reached);
            }
            before = Some(reached);
            let next = weight * FALL;
            y = self.predicted(&y, &local, weight, next).unwrap_or(y);
            steps += 1;
            weight = next;
        }
    }

    /// ν, the parameter of the barrier: 4 for a body and 1 for what is positive.
    fn corners(&self) -> f64 {
        (4 * self.bodies.len() + self.positive.len()).max(1) as f64
    }

    /// ν + Σ tr P₀⁻¹P.
    fn reach(&self, y: &DVector<f64>, inverse: &[Matrix4<f64>]) -> f64 {
        let of_body =
            |(standard, prior): (&Standard, &Matrix4<f64>)| prior.dot(&pseudo_inertia(&standard.data.0[0]));
        self.corners() + self.standard(y).iter().zip(inverse).map(of_body).sum::<f64>()
    }

    /// How far the least F can be below that of a point near the centre of weight μ, by Newton's decrement there, squared.
    ///
    /// F is convex, and at the centre its gradient is −μ times the barrier's, so that with a pull towards P₀
    /// F(y) − F(y*) ≤ μ (ν + Σ tr P₀⁻¹(P* − P) − tr P⁻¹P*). Of this ν + Σ tr P₀⁻¹P is kept, which is no less unless
    /// tr P₀⁻¹P* exceeds twice tr P₀⁻¹P. A decrement λ = β √μ adds μ (β + √ν) β / (1 − β) (Nesterov, *Lectures on Convex
    /// Optimization*, 2018, theorem 5.3.10); for β ≥ 1 nothing is known.
    fn gap(&self, y: &DVector<f64>, inverse: &[Matrix4<f64>], weight: f64, decrement: f64) -> Option<f64> {
        let (reach, beta) = (self.reach(y, inverse), (decrement.max(0.0) / weight).sqrt());
        (beta < 1.0).then(|| weight * (reach + (beta + reach.sqrt()) * beta / (1.0 - beta)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physical::adjoint;
    use crate::statistics::Random;

    /// Bodies whose estimates are anything, with something positive beside them, and a point inside.
    fn any(seed: u64, bodies: usize) -> (Program, DVector<f64>) {
        let mut random = Random::new(seed);
        let mut next = || 2.0 * random.uniform() - 1.0;
        let n = 10 * bodies + 2;
        let spread = DMatrix::from_fn(n, n, |r, c| if r == c { 1.0 } else { 0.2 * next() } * 0.3);
        let centre = DVector::from_fn(n, |_, _| next());
        // Inside: balls, and numbers that are one.
        let mut inside = DVector::from_element(n, 1.0);
        let ball = Matrix4::from_diagonal(&nalgebra::Vector4::new(0.1, 0.1, 0.1, 1.0));
        let own = crate::physical::standard_of(&ball);
        (0..bodies).for_each(|b| inside.rows_mut(10 * b, 10).copy_from(&own));
        let start = spread.clone().lu().solve(&(&inside - &centre)).unwrap();
        let program = Program {
            free: 0,
            seen: n,
            scale: 1.7,
            bodies: (0..bodies)
                .map(|b| BodyMap {
                    of: spread.rows(10 * b, 10).into_owned(),
                    at: Standard::from_iterator(centre.rows(10 * b, 10).iter().copied()),
                    prior: ball,
                    pull_weight: 0.0,
                })
                .collect(),
            positive: (n - 2..n).map(|k| Positive { of: spread.row(k).transpose(), at: centre[k] }).collect(),
        };
        (program, start)
    }

    /// For any Z ⪰ 0 and λ ≥ 0, min ½ ‖ξ‖²/s − Σ tr(Z_l P_l) − Σ λ_k p_k is below the loss of all that is possible: with
    /// those of the barrier it certifies, without trusting the search, how far the optimum can be.
    #[test]
    fn a_dual_point_certifies_the_optimum() {
        for seed in 1..=40 {
            let (program, start) = any(seed, 3);
            let tolerance = 1e-6;
            let reached = program.solve(start, tolerance).unwrap();
            assert!(reached.converged, "{seed}: {} steps", reached.steps);
            let mut linear = DVector::zeros(program.seen);
            let mut constant = 0.0;
            for (body, standard) in program.bodies.iter().zip(program.standard(&reached.at)) {
                // A square, and so positive semidefinite whatever rounding does.
                let l = pseudo_inertia(&standard.data.0[0]).cholesky().unwrap().l();
                let root = l.solve_lower_triangular(&Matrix4::identity()).unwrap();
                let z = root.transpose() * root * reached.weight;
                linear += body.of.tr_mul(&adjoint(&z));
                constant += adjoint(&z).dot(&body.at);
            }
            for p in &program.positive {
                let multiplier = reached.weight / (p.at + p.of.dot(&reached.at));
                assert!(multiplier > 0.0);
                linear.axpy(multiplier, &p.of, 1.0);
                constant += multiplier * p.at;
            }
            let bound = -0.5 * program.scale * linear.norm_squared() - constant;
            let gap = reached.loss - bound;
            assert!(
                gap >= -1e-9 && gap <= 1e-5 * (1.0 + reached.loss),
                "{seed}: {gap:e} of {}",
                reached.loss
            );
        }
    }

    /// Wherever a search is stopped, the loss that it states as within reach is.
    #[test]
    fn the_bound_of_a_search_that_was_stopped_is_true() {
        for seed in 1..=40 {
            let (program, start) = any(seed, 3);
            let least = program.solve(start.clone(), 1e-6).unwrap().loss;
            let mut stopped = 0;
            for most_steps in 1..=60 {
                let reached = program.solve_in(start.clone(), 1e-6, most_steps).unwrap();
                let above = reached.loss - least;
                assert!(
                    above <= reached.within + 1e-6,
                    "{seed}, {most_steps} steps: {above:e} above, {:e} stated",
                    reached.within
                );
                stopped += usize::from(!reached.converged);
            }
            assert!(stopped > 5, "{seed}: {stopped}");
        }
    }

    #[test]
    fn a_strong_pull_reaches_the_prior() {
        for seed in 1..=10 {
            let (mut strong, start) = any(seed, 2);
            strong.bodies.iter_mut().for_each(|body| body.pull_weight = 1e8);
            let reached = strong.solve(start, 1e-5).unwrap();
            for (body, standard) in strong.bodies.iter().zip(strong.standard(&reached.at)) {
                let away = (pseudo_inertia(&standard.data.0[0]) - body.prior).norm() / body.prior.norm();
                assert!(away < 2e-3, "{seed}: {away}");
            }
        }
    }

    #[test]
    fn a_start_outside_is_refused() {
        let (program, start) = any(1, 1);
        assert!(program.solve(start * 1e6, 1e-3).is_none());
    }
}
