
/// The solution of dH/dq = (1 - H s/g)/p after the displacement dq, s its sign; within -1 and 1.
fn relax(h: f64, dq: f64, presliding: f64, level: f64) -> f64 {
    let share = -expm1(-fabs(dq) / (presliding * level));
    let force = h + (copysign(level, dq) - h) * share;
    within_one(force)
}
