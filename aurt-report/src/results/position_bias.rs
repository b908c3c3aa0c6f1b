//! What noise of the positions does to least squares, in a sentence.

use aurt_calibration::PositionBias;
use aurt_traits::RobotNames;

use crate::rendering::number::significant;

/// The noise of the worst joint and the largest bias.
pub fn sentence(report: &PositionBias, names: RobotNames<'_>) -> String {
    let worst = report
        .joints
        .iter()
        .enumerate()
        .max_by(|a, b| a.1.acceleration_share.total_cmp(&b.1.acceleration_share));
    let noise = worst.map_or_else(String::new, |(joint, noise)| {
        format!(
            "noise of the positions is at most {} % of the power of the accelerations ({})",
            significant(100.0 * noise.acceleration_share, 2),
            names.joint(joint)
        )
    });
    let test = report.hausman.as_ref().map_or_else(String::new, |test| {
        let probability = match test.probability {
            p if p < 1e-3 => "p < 0.001".to_owned(),
            p => format!("p = {p:.3}"),
        };
        let agree = match (test.is_biased(), test.is_beyond_noise()) {
            (false, _) => "agree",
            (true, false) => "do not agree: least squares is biased",
            (true, true) => "differ by more than the position noise explains",
        };
        format!(
            "; least squares and instrumental variables {agree} (Durbin, Wu, Hausman: χ² = {} with {} degrees of freedom, {probability})",
            significant(test.statistic, 3),
            test.freedom
        )
    });
    let largest = report.parameters.iter().max_by(|a, b| a.deviations.abs().total_cmp(&b.deviations.abs()));
    match largest {
        Some(p) => format!(
            "{noise}; it biases coefficients by at most {} standard deviations ({}){test}",
            significant(p.deviations.abs(), 2),
            p.name
        ),
        None => format!("{noise}; it does not bias coefficients{test}"),
    }
}
