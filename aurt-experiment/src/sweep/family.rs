//! Points that share recordings and rigid bodies.

use crate::Experiment;
use aurt_calibration::{FitRows, RigidRows};
use aurt_plugins::model::{Error, RigidBodyDynamics};
use aurt_traits::{MeasurementUnit, RobotModel};
use toml::Table;

use crate::sweep::definition::Validate;
use crate::sweep::loading::{Data, Settings};
use crate::sweep::{Point, PointError};

/// What of an experiment does not touch the rows of the rigid bodies: points that differ in nothing else share them.
const FREE_SECTIONS: [&str; 3] = ["joint_dynamics", "arm_terms", "plugins"];
/// The same within `[calibration]`; `rest` chooses rows.
const FREE_KEYS: [&str; 3] = ["estimator", "load_torque", "fit_shapes"];

pub(crate) fn common_part(text: &str) -> String {
    let Ok(mut document) = toml::from_str::<Table>(text) else { return text.to_owned() };
    for section in FREE_SECTIONS {
        document.remove(section);
    }
    if let Some(calibration) = document.get_mut("calibration").and_then(toml::Value::as_table_mut) {
        for key in FREE_KEYS {
            calibration.remove(key);
        }
        if calibration.is_empty() {
            document.remove("calibration");
        }
    }
    document.to_string()
}

pub(crate) struct SharedRows<'r> {
    /// The fits: the rows that each is fitted to, and the indices in `judged` of the recordings that it is judged on.
    pub folds: Vec<(FitRows<'r>, Vec<usize>)>,
    pub judged: &'r RigidRows<'r>,
    pub bodies: &'r RigidBodyDynamics,
    pub unit: MeasurementUnit,
    pub warnings: &'r [String],
}

/// The robot model of an experiment on rigid bodies that are known already.
pub(crate) fn point_model(
    experiment: &Experiment,
    bodies: &RigidBodyDynamics,
) -> Result<RobotModel, PointError> {
    let stacks = experiment.joint_dynamics.stacks(experiment.joints()).map_err(Error::Assembly)?;
    Ok(bodies.clone().with_joint_dynamics(stacks, experiment.arm_terms.clone())?)
}

/// Reads and preprocesses what the points of a family share, evaluates and filters the rigid bodies' columns, and hands
/// them over.
pub(crate) fn with_shared_rows<R>(
    first: &Point,
    validate: Validate,
    work: impl FnOnce(&SharedRows<'_>) -> R,
) -> Result<R, PointError> {
    let data = Data::read(&first.experiment, validate)?;
    let settings = Settings::of(&first.experiment);
    let Data { calibration, judged, unit, warnings } = &data;
    let bodies = first.experiment.rigid_body_dynamics()?;
    let model = point_model(&first.experiment, &bodies)?;
    let (fitted, held_out) =
        rayon::join(|| RigidRows::new(&model, calibration), || RigidRows::new(&model, judged));
    let (fitted, held_out) = (fitted?, held_out?);
    let all = 0..calibration.len();
    let folds = match validate {
        Validate::HeldOut => vec![(all.collect::<Vec<_>>(), (0..judged.len()).collect())],
        Validate::LeaveOneOut => {
            all.clone().map(|out| (all.clone().filter(|r| *r != out).collect(), vec![out])).collect()
        }
    };
    let folds = folds
        .into_iter()
        .map(|(chosen, judged)| Ok((FitRows::new(&fitted, &chosen, &settings.calibration)?, judged)))
        .collect::<Result<_, PointError>>()?;
    Ok(work(&SharedRows { folds, judged: &held_out, bodies: &bodies, unit: *unit, warnings }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_touches_the_rigid_bodies_rows_is_not_free() {
        let text = |friction: &str, f_dyn: f64, rest: &str| {
            format!(
                "[joint_dynamics]\ncoulomb = {{ model = \"{friction}\" }}\n[preprocess]\nf_dyn_hz = {f_dyn}\n\
                 [calibration]\nestimator = \"ols\"\nrest = \"{rest}\"\n"
            )
        };
        let one = common_part(&text("constant", 5.0, "keep"));
        assert_eq!(one, common_part(&text("square", 5.0, "keep")));
        assert_ne!(one, common_part(&text("constant", 2.5, "keep")));
        assert_ne!(one, common_part(&text("constant", 5.0, "exclude")));
        assert_eq!(common_part("a = 1\n[calibration]\nestimator = \"ols\"\n"), common_part("a = 1\n"));
    }
}
