use super::section::Section;

/// `[calibration]`: how the coefficients are found. All keys are optional.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Calibration {
    /// `estimator`.
    pub estimator: Estimator,
    /// `load_torque`.
    pub load_torque: LoadTorqueChoice,
    /// `rest`.
    pub rest: Rest,
    /// `fit_shapes`: whether parameters in which models are not linear (Stribeck velocity, presliding distance) are
    /// searched too; true by default. What the experiment writes for them is then one start of the search among
    /// several; with false it stays as written.
    pub fit_shapes: bool,
}

impl Default for Calibration {
    fn default() -> Self {
        Self {
            estimator: Estimator::default(),
            load_torque: LoadTorqueChoice::default(),
            rest: Rest::default(),
            fit_shapes: true,
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
    pub(super) fn read(mut section: Section<'_, '_>) -> Self {
        let estimator = section.choice(
            "estimator",
            &[
                ("wls", Estimator::WeightedLeastSquares),
                ("ols", Estimator::OrdinaryLeastSquares),
                ("consistent", Estimator::Consistent),
                ("essential", Estimator::Essential),
                ("irls", Estimator::ReweightedLeastSquares),
            ],
        );
        let load_torque = section.choice(
            "load_torque",
            &[("fitted", LoadTorqueChoice::Fitted), ("literal", LoadTorqueChoice::Literal)],
        );
        let rest = section.choice("rest", &[("keep", Rest::Keep), ("exclude", Rest::Exclude)]);
        let fit_shapes = section.boolean("fit_shapes");
        section.finish();
        Self {
            estimator: estimator.unwrap_or_default(),
            load_torque: load_torque.unwrap_or_default(),
            rest: rest.unwrap_or_default(),
            fit_shapes: fit_shapes.unwrap_or(true),
        }
    }
}
