//! What weights by row did, in a sentence.

use aurt_calibration::RobustReport;
use aurt_traits::RobotNames;

use crate::rendering::number::significant;

/// The share of rows without weight, at the joint with most of them.
pub fn sentence(report: &RobustReport, names: RobotNames<'_>) -> String {
    let most = report.rejected.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
    most.map_or_else(String::new, |(joint, share)| {
        format!(
            "weights by row: at most {} % of the rows of a joint have no weight ({})",
            significant(100.0 * share, 2),
            names.joint(joint)
        )
    })
}
