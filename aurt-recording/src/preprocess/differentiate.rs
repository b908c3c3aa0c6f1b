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

#[cfg(test)]
mod tests {
    use serde_json::Value;

    use super::*;

    /// Values of `numpy.gradient` and of the stencil, made by `tests/reference/make_reference.py`.
    #[test]
    fn equals_numpy() {
        let case: Value =
            serde_json::from_str(include_str!("../../tests/reference/derivatives.json")).unwrap();
        let numbers = |key: &str| {
            case[key].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect::<Vec<f64>>()
        };
        let (position, period_s) = (numbers("position"), case["period_s"].as_f64().unwrap());
        for (own, expected) in [
            (velocity(&position, period_s), numbers("gradient")),
            (inner_acceleration(&position, period_s), numbers("acceleration")),
        ] {
            assert_eq!(own.len(), expected.len());
            let scale = expected.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            assert!(own.iter().zip(&expected).all(|(o, e)| (o - e).abs() < 1e-15 * scale));
        }
    }
}
