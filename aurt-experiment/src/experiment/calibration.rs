use aurt_plugins::Node;
use aurt_traits::KnownBodies;

use super::{robot::Robot, section::Section};

/// `[calibration]`: how the coefficients are found. All keys are optional.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Calibration {
    pub estimator: Estimator,
    pub load_torque: LoadTorqueChoice,
    pub rest: Rest,
    /// `fit_shapes`: whether parameters in which models are not linear (Stribeck velocity, presliding distance) are
    /// searched too; true by default. What the experiment writes for them is then one start of the search among
    /// several; with false it stays as written.
    pub fit_shapes: bool,
    /// `prior = "description"`, as its `prior_weight`: the inertial parameters of the robot's URDF or MJCF file are what
    /// `"consistent"` estimates are pulled towards, by 1/σ², where σ is the relative standard deviation of the file's masses and
    /// second moments. With zero they decide only what the recordings leave open.
    pub prior_weight: Option<f64>,
}

impl Default for Calibration {
    fn default() -> Self {
        Self {
            estimator: Estimator::default(),
            load_torque: LoadTorqueChoice::default(),
            rest: Rest::default(),
            fit_shapes: true,
            prior_weight: None,
        }
    }
}

/// `estimator`: how the joints' residuals are weighted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Estimator {
    /// `"wls"`: each joint by 1/σ² of its residual under ordinary least squares (equations 13, 14).
    #[default]
    WeightedLeastSquares,
    /// `"ols"`: all joints alike.
    OrdinaryLeastSquares,
    /// `"consistent"`: as `"wls"`, then the nearest machine that can exist: links and loads of positive mass that some
    /// distribution of it has, rotors of positive inertia, friction that brakes at all speeds and loads of the calibration.
    Consistent,
    /// `"essential"`: as `"wls"`, with the fewest parameters that predict blocks of time held out as well as all of them.
    Essential,
    /// `"irls"`: as `"wls"`, with weights by row in which impacts count little or nothing.
    ReweightedLeastSquares,
    /// `"output_error"`: the closed loop of the `[drive]`s is simulated from its commands, and positions are compared.
    OutputError,
}

/// `load_torque`: how the load τ_J of load-dependent friction is formed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LoadTorqueChoice {
    /// `"fitted"`: from the coefficients of a first fit, then a second one.
    #[default]
    Fitted,
    /// `"literal"`: the paper's, the sum of the base regressor's row.
    Literal,
}

/// `rest`: what happens to samples of a joint that rests, where the sign of its velocity is noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Rest {
    /// `"keep"`: they are fitted like all others.
    #[default]
    Keep,
    /// `"exclude"`: the joint's rows at rest are left out.
    Exclude,
}

impl Calibration {
    pub(super) fn read(mut section: Section<'_, '_>, robot: Option<&Robot>, driven: bool) -> Self {
        let estimator_node = section.take("estimator");
        let estimator = section.choice(
            "estimator",
            &[
                ("wls", Estimator::WeightedLeastSquares),
                ("ols", Estimator::OrdinaryLeastSquares),
                ("consistent", Estimator::Consistent),
                ("essential", Estimator::Essential),
                ("irls", Estimator::ReweightedLeastSquares),
                ("output_error", Estimator::OutputError),
            ],
        );
        if let Some(node) = estimator_node.filter(|_| estimator.is_some()) {
            match (estimator == Some(Estimator::OutputError), driven) {
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
        let load_torque = section.choice(
            "load_torque",
            &[("fitted", LoadTorqueChoice::Fitted), ("literal", LoadTorqueChoice::Literal)],
        );
        let rest = section.choice("rest", &[("keep", Rest::Keep), ("exclude", Rest::Exclude)]);
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
        Self {
            estimator: estimator.unwrap_or(if driven {
                Estimator::OutputError
            } else {
                Estimator::default()
            }),
            load_torque: load_torque.unwrap_or_default(),
            rest: rest.unwrap_or_default(),
            fit_shapes: fit_shapes.unwrap_or(true),
            prior_weight: prior.map(|_| weight.unwrap_or(KnownBodies::USUAL_WEIGHT)),
        }
    }
}

/// Whether a `prior` is one that there is, for an estimator that uses it.
fn is_usable(
    section: &Section<'_, '_>,
    node: &Node,
    estimator: Option<Estimator>,
    robot: Option<&Robot>,
) -> bool {
    let complain = |message: &str, help: &str| {
        section.complain("prior", node, message, Some(help.to_owned()));
        false
    };
    match section.text_of("prior", node) {
        None => false,
        Some("description") if estimator != Some(Estimator::Consistent) => {
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
