
/// Dahl's model; memory: H and the previous position.
fn dahl(m: &mut [f64], q: f64, presliding: f64) -> f64 {
    m[0] = relax(m[0], q - m[1], presliding, 1.0);
    m[1] = q;
    m[0]
}
