
/// The slope of the force along the motion against the distance in units of the presliding distance.
fn bouc_wen_slope(along: f64, exponent: f64, beta: f64) -> f64 {
    let size = if exponent == 1.0 { fabs(along) } else { pow(fabs(along), exponent) };
    if along >= 0.0 { 1.0 - size } else { 1.0 + (2.0 * beta - 1.0) * size }
}

/// The distance in which a small opposing force falls to zero: three-point Gauss-Legendre quadrature of 1/slope.
fn bouc_wen_to_zero(against: f64, exponent: f64, beta: f64) -> f64 {
    let node = sqrt(0.6) / 2.0;
    let a = 1.0 / bouc_wen_slope(-against * (0.5 - node), exponent, beta);
    let b = 1.0 / bouc_wen_slope(-against * 0.5, exponent, beta);
    let c = 1.0 / bouc_wen_slope(-against * (0.5 + node), exponent, beta);
    against * (5.0 * a + 8.0 * b + 5.0 * c) / 18.0
}

/// The Bouc-Wen model, integrated along the path; memory: H and the previous position.
fn bouc_wen(m: &mut [f64], q: f64, presliding: f64, exponent: f64, beta: f64) -> f64 {
    let longest = 1.0 / 16.0;
    let displacement = q - m[1];
    let direction = if displacement < 0.0 { -1.0 } else { 1.0 };
    let mut along = m[0] * direction;
    let mut distance = fabs(displacement) / presliding;
    while distance > 0.0 && along < 1.0 - 1e-12 {
        let mut step = if distance < longest { distance } else { longest };
        if along < 0.0 && -along <= 2.0 * longest {
            let to_zero = bouc_wen_to_zero(-along, exponent, beta);
            if to_zero <= distance {
                along = 0.0;
                distance -= to_zero;
                continue;
            }
            step = distance;
        }
        let k1 = bouc_wen_slope(along, exponent, beta);
        let k2 = bouc_wen_slope(along + 0.5 * step * k1, exponent, beta);
        let k3 = bouc_wen_slope(along + 0.5 * step * k2, exponent, beta);
        let k4 = bouc_wen_slope(along + step * k3, exponent, beta);
        along += step * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0;
        along = if along > 1.0 { 1.0 } else { along };
        distance -= step;
    }
    m[0] = along * direction;
    m[1] = q;
    m[0]
}
