
/// The Stribeck curve relative to break-away, r + (1 - r) exp(-|v/v_S|^d).
fn level(v: f64, scale: f64, ratio: f64, exponent: f64) -> f64 {
    let x = fabs(v / scale);
    let power = if exponent == 2.0 {
        x * x
    } else if exponent == 1.0 {
        x
    } else {
        pow(x, exponent)
    };
    ratio + (1.0 - ratio) * exp(-power)
}
