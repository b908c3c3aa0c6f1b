
/// ln(1 + t/T).
fn warmth(t: f64, warming_time: f64) -> f64 {
    if t > 0.0 { log1p(t / warming_time) } else { 0.0 }
}
