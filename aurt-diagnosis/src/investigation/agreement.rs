//! The value that joints agree on.

use aurt_calibration::two_sided;

/// The mean of the delays of joints, with the joint as the unit. One clock stamps all joints, while friction and gears are those of
/// each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Agreement {
    pub(super) mean_s: f64,
    /// Its standard deviation, s.
    pub(super) std_s: f64,
    /// Degrees of freedom of the deviation: the joints beyond the first where they differ by more than their own variances.
    pub(super) freedom: f64,
}

/// Degrees of freedom of a deviation that follows from known variances.
const NORMAL: f64 = 1e6;

/// Share of arms whose joints lag each by an amount of its own, around none, that are taken for late.
const FALSE_AGREEMENTS: f64 = 0.01;

impl Agreement {
    /// The test of the mean against none, by Student's t.
    pub(super) fn is_clear(&self) -> bool {
        two_sided(self.mean_s / self.std_s, self.freedom) < FALSE_AGREEMENTS
    }
}

/// The agreement of joints that show a delay, s, of a variance each: what differs between them beyond their own variances is a variance
/// of its own (DerSimonian and Laird 1986, *Control. Clin. Trials* 7; Hartung and Knapp 2001, *Stat. Med.* 20). None where fewer
/// than two of several joints tell.
pub(super) fn agreement(joints: &[Option<[f64; 2]>]) -> Option<Agreement> {
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
    let freedom = if between > 0.0 { others } else { NORMAL };
    Some(Agreement { mean_s: mean, std_s: (spread / sum).sqrt(), freedom })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_of_joints_is_as_uncertain_as_they_differ() {
        let alike = agreement(&[Some([1.0, 0.01]), Some([1.0, 0.04]), None]).unwrap();
        assert!((alike.mean_s - 1.0).abs() < 1e-12 && (alike.std_s - (1.0_f64 / 125.0).sqrt()).abs() < 1e-12);
        // Deviations that are small beside what differs: the deviation of a mean of three numbers.
        let apart = agreement(&[0.0, 1.0, 5.0].map(|d| Some([d, 1e-9]))).unwrap();
        assert!((apart.mean_s - 2.0).abs() < 1e-6 && (apart.std_s - (7.0_f64 / 3.0).sqrt()).abs() < 1e-6);
        assert_eq!(agreement(&[Some([1.0, 0.1]), None]), None);
        assert!(agreement(&[Some([1.0, 0.1])]).is_some());
    }

    #[test]
    fn few_joints_have_to_be_clearer() {
        let of = |freedom, t: f64| Agreement { mean_s: -t, std_s: 1.0, freedom }.is_clear();
        // Quantiles of Student's t: 2.58 of a normal number, 3.71 of seven joints.
        assert!(of(NORMAL, 2.6) && !of(NORMAL, 2.5));
        assert!(!of(6.0, 3.6) && of(6.0, 3.8));
    }
}
