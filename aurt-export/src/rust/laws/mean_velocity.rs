
/// The mean velocity of a step; the measured one where time does not advance.
fn mean_velocity(displacement: f64, duration: f64, v: f64) -> f64 {
    if duration > 0.0 { displacement / duration } else { v }
}
