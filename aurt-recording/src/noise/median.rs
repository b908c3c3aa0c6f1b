/// The median of at least one value; the values are reordered.
#[must_use]
pub fn median(values: &mut [f64]) -> f64 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The median distance of stamps that differ, s; none without two.
#[must_use]
pub fn median_step_s(time_s: &[f64]) -> Option<f64> {
    let mut steps: Vec<f64> = time_s.windows(2).map(|w| w[1] - w[0]).filter(|d| *d > 0.0).collect();
    (!steps.is_empty()).then(|| median(&mut steps))
}
