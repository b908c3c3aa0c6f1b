
/// The LuGre model without bristle damping; memory: H, time and position of the previous sample.
#[allow(clippy::too_many_arguments)]
fn lugre(
    m: &mut [f64],
    t: f64,
    q: f64,
    v: f64,
    presliding: f64,
    scale: f64,
    ratio: f64,
    exponent: f64,
) -> f64 {
    let displacement = q - m[2];
    let duration = if t > m[1] { t - m[1] } else { 0.0 };
    let g = level(mean_velocity(displacement, duration, v), scale, ratio, exponent);
    m[0] = relax(m[0], displacement, presliding, g);
    m[1] = t;
    m[2] = q;
    m[0]
}
