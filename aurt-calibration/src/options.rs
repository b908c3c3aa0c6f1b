use aurt_traits::RigidBodyRegressor;
use serde::{Deserialize, Serialize};

/// Which least-squares weights are used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Estimator {
    /// Weights 1/σ_j² from a first OLS (paper, equations 13 and 14).
    #[default]
    Wls,
    /// All joints weighted alike.
    Ols,
    /// As [`Wls`](Self::Wls), then the nearest machine that can exist ([`make_consistent`](crate::make_consistent)).
    Consistent,
    /// As [`Wls`](Self::Wls), with the fewest parameters that predict blocks held out as well as all of them.
    Essential,
    /// As [`Wls`](Self::Wls), with weights by row in which impacts count little or nothing.
    Irls,
}

impl Estimator {
    /// All of them, as experiments, options and results write them.
    pub const NAMES: [(&str, Self); 5] = [
        ("wls", Self::Wls),
        ("ols", Self::Ols),
        ("consistent", Self::Consistent),
        ("essential", Self::Essential),
        ("irls", Self::Irls),
    ];

    /// Whether joints are weighted by their residuals.
    pub const fn is_weighted(self) -> bool {
        !matches!(self, Self::Ols)
    }
}

/// How the load torque τ_J of load-dependent friction is formed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LoadTorqueChoice {
    /// From the fitted rigid bodies: a first fit without load dependence supplies them.
    #[default]
    Fitted,
    /// The paper's: the sum of the base regressor's row.
    Literal,
}

impl LoadTorqueChoice {
    /// Both, as experiments, options and results write them.
    pub const NAMES: [(&str, Self); 2] = [("fitted", Self::Fitted), ("literal", Self::Literal)];
}

/// What calibration does with samples at which a joint rests (|q̇_j| at or below the rest velocity), where the
/// sign of velocity is that of rounding noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Rest {
    /// They count like all others (the paper).
    #[default]
    Keep,
    /// A joint's row is left out of the fit while the joint rests.
    Exclude,
}

impl Rest {
    /// Both, as experiments, options and results write them.
    pub const NAMES: [(&str, Self); 2] = [("keep", Self::Keep), ("exclude", Self::Exclude)];

    /// Share of a joint's rows at rest from which they should not be kept. There the sign of the velocity is that of noise, of power 1 at
    /// most: the level of dry friction that is fitted to it as well comes out too low by this share at most.
    pub const MOST_KEPT: f64 = 0.1;
}

/// What standard deviations count.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Deviations {
    /// Noise with the memory that the residuals have, recordings that repeat, and misfit that differs from stretch to
    /// stretch.
    #[default]
    Memory,
    /// Noise that is white before the parallel filter; faster, since the rows are not looked at again.
    White,
}

/// Settings of a calibration.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CalibrationOptions {
    /// Least-squares weights.
    pub estimator: Estimator,
    /// Load torque of load-dependent friction.
    pub load_torque: LoadTorqueChoice,
    /// Treatment of resting samples in the fit.
    pub rest: Rest,
    /// At and below this |q̇_j| a joint rests, rad/s; validation reports samples above it as moving. Of joints that slide it is
    /// [`Self::rest_velocity`].
    pub rest_velocity_rad_s: f64,
    /// Whether [`calibrate_shapes`](crate::calibrate_shapes) searches the parameters in which models are not linear;
    /// otherwise, and with [`calibrate`](crate::calibrate), they stay as the model has them.
    #[serde(default = "yes")]
    pub fit_shapes: bool,
    /// What standard deviations count.
    #[serde(default)]
    pub deviations: Deviations,
}

/// Lever of a sliding joint's speed, m: divided by it, it is compared with that of a joint that turns.
pub const SLIDE_LEVER_M: f64 = 0.1;

const fn yes() -> bool {
    true
}

/// The speed of a joint that compares with one of joints that turn: in m/s, at [`SLIDE_LEVER_M`] from an axis, where it slides.
pub fn speed_of(bodies: &dyn RigidBodyRegressor, joint: usize, turning_rad_s: f64) -> f64 {
    if bodies.slides(joint) { SLIDE_LEVER_M * turning_rad_s } else { turning_rad_s }
}

impl CalibrationOptions {
    /// At and below this |q̇_j| a joint rests, in rad/s, and in m/s where it slides: there, what 0.1 m away from an axis moves at
    /// [`Self::rest_velocity_rad_s`], the length of a short link.
    pub fn rest_velocity(&self, bodies: &dyn RigidBodyRegressor, joint: usize) -> f64 {
        speed_of(bodies, joint, self.rest_velocity_rad_s)
    }

    /// [`Self::rest_velocity`] of each joint.
    pub fn rest_velocities(&self, bodies: &dyn RigidBodyRegressor) -> Vec<f64> {
        (0..bodies.joints()).map(|joint| self.rest_velocity(bodies, joint)).collect()
    }

    /// Whether what noise of the positions does is told, and part of the deviations.
    pub(crate) const fn tells_position_bias(&self) -> bool {
        matches!(self.deviations, Deviations::Memory)
            && matches!(self.estimator, Estimator::Wls | Estimator::Ols | Estimator::Consistent)
    }
}

impl Default for CalibrationOptions {
    fn default() -> Self {
        Self {
            estimator: Estimator::default(),
            load_torque: LoadTorqueChoice::default(),
            rest: Rest::default(),
            rest_velocity_rad_s: 0.03,
            fit_shapes: true,
            deviations: Deviations::default(),
        }
    }
}
