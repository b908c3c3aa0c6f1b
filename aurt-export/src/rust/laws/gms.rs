
/// Moves one element, its force m[0] and the direction m[1] in which it slips, over a step at the level g.
fn gms_element(m: &mut [f64], threshold: f64, displacement: f64, duration: f64, g: f64, attraction: f64) {
    let distance = fabs(displacement);
    let direction = if displacement < 0.0 { -1.0 } else { 1.0 };
    let mut along = m[0] * direction;
    let mut slipping = duration;
    if distance == 0.0 {
        m[1] = 0.0;
        return;
    }
    if m[1] != direction {
        let to_slip = (g - along) * threshold;
        if to_slip >= distance {
            m[0] = (along + distance / threshold) * direction;
            m[1] = 0.0;
            return;
        }
        if to_slip > 0.0 {
            along = g;
            slipping *= 1.0 - to_slip / distance;
        }
        m[1] = direction;
    }
    if along != g {
        along = g + (along - g) * exp(-slipping * attraction / g);
    }
    m[0] = within_one(along) * direction;
}

/// Generalised Maxwell-slip elements; memory: time and position of the previous sample, two numbers for each element.
#[allow(clippy::too_many_arguments)]
fn gms(
    m: &mut [f64],
    t: f64,
    q: f64,
    v: f64,
    thresholds: &[f64],
    scale: f64,
    ratio: f64,
    exponent: f64,
    attraction: f64,
    h: &mut [f64],
) {
    let displacement = q - m[1];
    let duration = if t > m[0] { t - m[0] } else { 0.0 };
    let g = level(mean_velocity(displacement, duration, v), scale, ratio, exponent);
    m[0] = t;
    m[1] = q;
    for ((element, threshold), force) in m[2..].chunks_exact_mut(2).zip(thresholds).zip(h) {
        gms_element(element, *threshold, displacement, duration, g, attraction);
        *force = element[0];
    }
}
