//! Shape parameters that a calibration searched, as a table.

use aurt_calibration::ShapeReport;
use aurt_traits::{ColumnGroup, RobotNames};

use crate::rendering::number::significant;
use crate::rendering::table::Table;

/// The shapes with their precision and how the search went.
pub fn to_text(report: &ShapeReport, names: RobotNames<'_>) -> String {
    let mut table =
        Table::new(["of", "model", "shape parameter", "value", "95 % interval", "starts"]).left(3);
    for shape in &report.shapes {
        let owner = match shape.group {
            ColumnGroup::RigidBody => String::new(),
            ColumnGroup::JointDynamics(joint) => names.joint(joint),
            ColumnGroup::ArmTerm(k) => format!("arm term {k}"),
        };
        let interval = match shape.interval_95 {
            Some([low, high]) => format!("{} … {}", significant(low, 3), significant(high, 3)),
            None if shape.at_bound => "at a bound".into(),
            None => "–".into(),
        };
        table.row([
            owner,
            shape.model.clone(),
            shape.name.clone(),
            match shape.unit.as_str() {
                "1" => significant(shape.value, 4),
                unit => format!("{} {unit}", significant(shape.value, 4)),
            },
            interval,
            format!("{}/{}", shape.agreeing_starts, report.starts),
        ]);
    }
    let end = if report.converged { "converged" } else { "not settled" };
    format!(
        "{}  {end} after {} iterations, {} evaluations; starts: how many of the refined ones agree\n",
        table.render(),
        report.iterations,
        report.evaluations
    )
}

#[cfg(test)]
mod tests {
    use aurt_calibration::FittedShape;
    use aurt_traits::Scale;

    use super::*;

    #[test]
    fn a_shape_at_its_bound_has_no_interval() {
        let shape = FittedShape {
            group: ColumnGroup::JointDynamics(2),
            model: "dahl".into(),
            name: "presliding_rad".into(),
            unit: "rad".into(),
            start: 0.01,
            value: 0.5,
            std_dev: None,
            interval_95: None,
            lower: 1e-5,
            upper: 0.5,
            scale: Scale::Logarithmic,
            at_bound: true,
            shift_by_position_noise: None,
            agreeing_starts: 3,
        };
        let report = ShapeReport {
            shapes: vec![shape],
            starts: 3,
            iterations: 12,
            evaluations: 80,
            converged: true,
            cost_before: 2.0,
            cost_after: 1.0,
        };
        let text = to_text(&report, RobotNames::default());
        assert!(
            text.contains("joint 2  dahl   presliding_rad   0.5000 rad     at a bound     3/3"),
            "{text}"
        );
        assert!(text.contains("converged after 12 iterations, 80 evaluations"), "{text}");
    }
}
