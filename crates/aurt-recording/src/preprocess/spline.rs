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
