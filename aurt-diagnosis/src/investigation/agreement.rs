//! The value that joints agree on.

/// The mean of the delays of joints, s, and its deviation, with the joint as the unit: what differs between them
/// beyond their own variances is a variance of its own (DerSimonian and Laird 1986, *Control. Clin. Trials* 7; Hartung and Knapp
/// 2001, *Stat. Med.* 20). One clock stamps all joints, while friction and gears are those of each. None where fewer than two of several
/// joints tell.
pub(super) fn agreement(joints: &[Option<[f64; 2]>]) -> Option<[f64; 2]> {
    let known: Vec<[f64; 2]> = joints.iter().flatten().copied().collect();
    if known.len() < joints.len().min(2) {
        return None;
    }
    let mean = |between: f64| {
        let weights = known.iter().map(|[_, variance]| 1.0 / (variance + between));
        let sum: f64 = weights.clone().sum();
        let mean = weights.clone().zip(&known).map(|(w, [d, _])| w * d).sum::<f64>() / sum;
        let squares: f64 = weights.clone().zip(&known).map(|(w, [d, _])| w * (d - mean).powi(2)).sum();
        (mean, sum, sum - weights.map(|w| w * w).sum::<f64>() / sum, squares)
    };
    let others = known.len() as f64 - 1.0;
    let (_, _, scale, squares) = mean(0.0);
    let between = if others > 0.0 { ((squares - others) / scale).max(0.0) } else { 0.0 };
    let (mean, sum, _, squares) = mean(between);
    let spread = if others > 0.0 { (squares / others).max(1.0) } else { 1.0 };
    Some([mean, (spread / sum).sqrt()])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_of_joints_is_as_uncertain_as_they_differ() {
        let [mean, deviation] = agreement(&[Some([1.0, 0.01]), Some([1.0, 0.04]), None]).unwrap();
        assert!((mean - 1.0).abs() < 1e-12 && (deviation - (1.0_f64 / 125.0).sqrt()).abs() < 1e-12);
        // Deviations that are small beside what differs: the deviation of a mean of three numbers.
        let [mean, deviation] = agreement(&[0.0, 1.0, 5.0].map(|d| Some([d, 1e-9]))).unwrap();
        assert!(
            (mean - 2.0).abs() < 1e-6 && (deviation - (7.0_f64 / 3.0).sqrt()).abs() < 1e-6,
            "{deviation}"
        );
        assert_eq!(agreement(&[Some([1.0, 0.1]), None]), None);
        assert!(agreement(&[Some([1.0, 0.1])]).is_some());
    }
}
