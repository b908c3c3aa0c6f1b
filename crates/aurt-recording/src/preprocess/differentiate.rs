/// Velocities by central differences of uniformly sampled positions, one-sided at both ends
/// (`numpy.gradient`): q̇_k = (q_{k+1} − q_{k−1}) / 2T.
pub(crate) fn velocity(position: &[f64], period_s: f64) -> Vec<f64> {
    let n = position.len();
    if n < 2 {
        return vec![0.0; n];
    }
    let mut out = Vec::with_capacity(n);
    out.push((position[1] - position[0]) / period_s);
    out.extend(position.windows(3).map(|w| (w[2] - w[0]) / (2.0 * period_s)));
    out.push((position[n - 1] - position[n - 2]) / period_s);
    out
}

/// Accelerations at the inner samples by the compact stencil q̈_k = (q_{k+1} − 2q_k + q_{k−1}) / T²,
/// two samples fewer than positions.
pub(crate) fn inner_acceleration(position: &[f64], period_s: f64) -> Vec<f64> {
    let scale = period_s * period_s;
    position.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]) / scale).collect()
}
