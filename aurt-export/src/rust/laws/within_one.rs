
/// The value between -1 and 1 that is next to x.
fn within_one(x: f64) -> f64 {
    if x > 1.0 {
        1.0
    } else if x < -1.0 {
        -1.0
    } else {
        x
    }
}
