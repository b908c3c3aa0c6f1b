/// The cubic spline through points (t_k, y_k) with two continuous derivatives and "not-a-knot" ends: the
/// first two and the last two intervals each share one cubic (the same as `scipy.interpolate.CubicSpline`).
///
/// Fewer than four points fall back on the polynomial through them.
pub(crate) struct CubicSpline<'a> {
    knots: &'a [f64],
    values: &'a [f64],
    slopes: Vec<f64>,
}

impl<'a> CubicSpline<'a> {
    /// The spline; `knots` increase strictly and are as many as `values`, at least one.
    pub(crate) fn new(knots: &'a [f64], values: &'a [f64]) -> Self {
        Self { knots, values, slopes: slopes(knots, values) }
    }

    /// The spline's values at the increasing `times`; outside the knots the end cubics are continued.
    pub(crate) fn sample(&self, times: &[f64]) -> Vec<f64> {
        let (t, y, s) = (self.knots, self.values, &self.slopes);
        if t.len() == 1 {
            return vec![y[0]; times.len()];
        }
        let mut k = 0;
        times
            .iter()
            .map(|time| {
                while k + 2 < t.len() && *time >= t[k + 1] {
                    k += 1;
                }
                let h = t[k + 1] - t[k];
                let x = time - t[k];
                let slope = (y[k + 1] - y[k]) / h;
                let curvature = (s[k] + s[k + 1] - 2.0 * slope) / h;
                let quadratic = (slope - s[k]) / h - curvature;
                y[k] + x * (s[k] + x * (quadratic + x * (curvature / h)))
            })
            .collect()
    }
}

/// The derivatives at the knots, from the tridiagonal system that makes the second derivative continuous.
fn slopes(t: &[f64], y: &[f64]) -> Vec<f64> {
    let n = t.len();
    let h: Vec<f64> = t.windows(2).map(|w| w[1] - w[0]).collect();
    let d: Vec<f64> = y.windows(2).zip(&h).map(|(w, h)| (w[1] - w[0]) / h).collect();
    match n {
        0 | 1 => return vec![0.0; n],
        2 => return vec![d[0]; 2],
        3 => {
            // The parabola through three points: its derivative at the ends and in the middle.
            let c = (d[1] - d[0]) / (h[0] + h[1]);
            return vec![d[0] - c * h[0], d[0] + c * h[0], d[1] + c * h[1]];
        }
        _ => {}
    }
    let mut diagonal = vec![0.0; n];
    let mut upper = vec![0.0; n];
    let mut lower = vec![0.0; n];
    let mut right = vec![0.0; n];
    for k in 1..n - 1 {
        lower[k] = h[k];
        diagonal[k] = 2.0 * (h[k - 1] + h[k]);
        upper[k] = h[k - 1];
        right[k] = 3.0 * (h[k] * d[k - 1] + h[k - 1] * d[k]);
    }
    let span = h[0] + h[1];
    diagonal[0] = h[1];
    upper[0] = span;
    right[0] = ((h[0] + 2.0 * span) * h[1] * d[0] + h[0] * h[0] * d[1]) / span;
    let (a, b) = (h[n - 3], h[n - 2]);
    let span = a + b;
    diagonal[n - 1] = a;
    lower[n - 1] = span;
    right[n - 1] = (b * b * d[n - 3] + (2.0 * span + b) * a * d[n - 2]) / span;
    // Elimination without pivoting: the inner rows dominate, the end rows are their own pivots.
    for k in 1..n {
        let factor = lower[k] / diagonal[k - 1];
        diagonal[k] -= factor * upper[k - 1];
        right[k] -= factor * right[k - 1];
    }
    right[n - 1] /= diagonal[n - 1];
    for k in (0..n - 1).rev() {
        right[k] = (right[k] - upper[k] * right[k + 1]) / diagonal[k];
    }
    right
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use serde_json::Value;

    use super::*;

    fn numbers(value: &Value) -> Vec<f64> {
        value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
    }

    /// Values of `scipy.interpolate.CubicSpline`, made by `tests/reference/make_reference.py`.
    #[test]
    fn equals_scipy() {
        let cases: Value = serde_json::from_str(include_str!("../../tests/reference/splines.json")).unwrap();
        for case in cases.as_array().unwrap() {
            let (knots, values) = (numbers(&case["knots"]), numbers(&case["values"]));
            let own = CubicSpline::new(&knots, &values).sample(&numbers(&case["at"]));
            for (own, expected) in own.iter().zip(numbers(&case["interpolated"])) {
                assert!((own - expected).abs() < 1e-12, "{} knots: {own} {expected}", knots.len());
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 50, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn a_cubic_is_its_own_spline(
            steps in prop::collection::vec(0.01_f64..0.1, 3..60),
            coefficients in prop::array::uniform4(-3.0_f64..3.0),
        ) {
            let mut knots = vec![0.0];
            for step in &steps {
                knots.push(knots[knots.len() - 1] + step);
            }
            let [a, b, c, d] = coefficients;
            let cubic = |t: f64| a + t * (b + t * (c + t * d));
            let values: Vec<f64> = knots.iter().map(|t| cubic(*t)).collect();
            let end = knots[knots.len() - 1];
            let at: Vec<f64> = (0..=100).map(|k| end * f64::from(k) / 100.0).collect();
            let scale = 1.0 + values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            for (t, y) in at.iter().zip(CubicSpline::new(&knots, &values).sample(&at)) {
                prop_assert!((y - cubic(*t)).abs() < 1e-10 * scale);
            }
        }
    }
}
