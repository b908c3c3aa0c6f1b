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
    let largest = report.parameters.iter().max_by(|a, b| a.deviations.abs().total_cmp(&b.deviations.abs()));
    match largest {
        Some(p) => format!(
            "{noise}; it biases coefficients by at most {} standard deviations ({})",
            significant(p.deviations.abs(), 2),
            p.name
        ),
        None => format!("{noise}; it does not bias coefficients"),
    }
}
