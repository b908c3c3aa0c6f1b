use aurt_calibration::{CalibrationOptions, Estimator, LoadTorqueChoice, Rest};
use aurt_plugins::Node;
use aurt_traits::KnownBodies;

use super::robot::Robot;
use super::section::Section;

/// `[calibration]`: how the coefficients are found, and the weight of `prior = "description"`. All keys are optional.
///
/// `estimator = "output_error"` is that of every `[drive]`, whose closed loop is simulated from its commands.
pub(super) fn read(
    mut section: Section<'_, '_>,
    robot: Option<&Robot>,
    driven: bool,
) -> (CalibrationOptions, Option<f64>) {
    let estimator_node = section.take("estimator");
    let mut estimators = Estimator::NAMES.map(|(name, estimator)| (name, Some(estimator))).to_vec();
    estimators.push(("output_error", None));
    let estimator = section.choice("estimator", &estimators);
    if let Some(node) = estimator_node.filter(|_| estimator.is_some()) {
        match (estimator == Some(None), driven) {
            (true, false) => section.complain(
                "estimator",
                node,
                "simulates drives, which are not described",
                Some("add [drive], for example with model = \"position_servo\"".to_owned()),
            ),
            (false, true) => section.complain(
                "estimator",
                node,
                "fits torques; commands of a [drive] are fitted by \"output_error\"",
                Some("remove `estimator`, or [drive]".to_owned()),
            ),
            _ => {}
        }
    }
    let estimator = estimator.flatten().unwrap_or_default();
    let load_torque = section.choice("load_torque", &LoadTorqueChoice::NAMES);
    let rest = section.choice("rest", &Rest::NAMES);
    let fit_shapes = section.boolean("fit_shapes");
    let prior = section.take("prior").filter(|node| is_usable(&section, node, estimator, robot));
    let weight_node = section.take("prior_weight");
    let weight = weight_node.and_then(|node| section.number_of("prior_weight", node));
    if let Some(node) = weight_node {
        if weight.is_some_and(|weight| weight < 0.0) {
            section.complain("prior_weight", node, "must not be negative", None);
        } else if prior.is_none() {
            section.complain("prior_weight", node, "weighs a `prior`, which is not given", None);
        }
    }
    section.finish();
    let options = CalibrationOptions {
        estimator,
        load_torque: load_torque.unwrap_or_default(),
        rest: rest.unwrap_or_default(),
        fit_shapes: fit_shapes.unwrap_or(true),
        ..CalibrationOptions::default()
    };
    (options, prior.map(|_| weight.unwrap_or(KnownBodies::USUAL_WEIGHT)))
}

/// Whether a `prior` is one that there is, for an estimator that uses it.
fn is_usable(section: &Section<'_, '_>, node: &Node, estimator: Estimator, robot: Option<&Robot>) -> bool {
    let complain = |message: &str, help: &str| {
        section.complain("prior", node, message, Some(help.to_owned()));
        false
    };
    match section.text_of("prior", node) {
        None => false,
        Some("description") if estimator != Estimator::Consistent => {
            complain("is for another estimator", "write estimator = \"consistent\", or remove the prior")
        }
        // Without a robot that is complained of already.
        Some("description") if robot.is_some_and(|r| r.geometry.standard_parameters().is_none()) => complain(
            "needs masses, which the robot's geometry does not state",
            "give `[robot]` a `urdf` or `mjcf` whose links have `inertial` elements",
        ),
        Some("description") => true,
        Some(other) => complain(
            &format!("expects \"description\", found {other:?}"),
            "the description is the `urdf` or `mjcf` of `[robot]`",
        ),
    }
}
