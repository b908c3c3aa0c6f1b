
/// Maxwell-slip elements; memory: the position of each anchor.
fn maxwell_slip(anchors: &mut [f64], q: f64, thresholds: &[f64], h: &mut [f64]) {
    for ((anchor, threshold), force) in anchors.iter_mut().zip(thresholds).zip(h) {
        if *anchor < q - threshold {
            *anchor = q - threshold;
        }
        if *anchor > q + threshold {
            *anchor = q + threshold;
        }
        *force = within_one((q - *anchor) / threshold);
    }
}
