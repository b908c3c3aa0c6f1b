//! Weighted least squares calibration of robot models from recordings (paper, section IV), and what belongs to
//! it: uncertainty, validation, prediction.
//!
//! The regressor is streamed: evaluated tile by tile, filtered in parallel with the measurement, decimated and
//! folded into one triangle per joint ([`JointFactor`]). These triangles answer every further question (OLS,
//! σ_j, WLS, subsets of columns, sums of recordings) without the samples ([`System`]). Where many models are fitted to
//! the same recordings, the rigid bodies' rows are shared ([`RigidRows`]); parameters in which a model is not linear
//! are searched ([`calibrate_shapes`]). Arms that record commands and positions are calibrated by output error ([`drives`]).

mod calibrate;
mod calibrated;
mod consistent;
mod dense;
mod deviations;
pub mod drives;
mod error;
mod errors_in_positions;
mod essential;
mod excitation;
mod gains;
mod linear;
mod long;
mod options;
mod physical;
mod recursive;
mod robust;
mod row_cache;
mod rows;
mod separability;
mod statistics;
mod system;
mod uncertainty;
mod validation;
mod variable_projection;

pub use calibrate::{calibrate, calibrate_scoped};
pub use calibrated::Calibration;
pub use consistent::{
    ConsistentReport, Fit, Moved, PossibleBody, Prior, PriorError, StandardEstimate, make_consistent,
    possible_body,
};
pub use dense::{add_gram, products_of_columns};
pub use error::CalibrationError;
pub use errors_in_positions::{FittedBandwidth, JointPositionNoise, ParameterBias, PositionBias};
pub use essential::{EssentialReport, EssentialStep};
pub use excitation::{badly_excited, hardly_excited};
pub use gains::{Decided, Gain, Gains, GainsError, GainsOf, KnownLoad, decidable_gains, estimate_gains};
pub use linear::condition_number;
pub use long::{calibrate_long, validate_long};
pub use options::{
    CalibrationOptions, Deviations, Estimator, LoadTorqueChoice, Rest, SLIDE_LEVER_M, speed_of,
};
pub use recursive::{
    Baseline, ChangePoint, Chart, Cusum, Cut, Drift, DriftEstimate, DriftGroup, DriftParameter,
    DriftReference, DriftWindow, LeftOut, MIN_WINDOWS, Tracker, average_run_length, drift_windows,
    own_residuals, threshold_for,
};
pub use robust::RobustReport;
pub use row_cache::{FitRows, JudgedRow, RigidRows};
pub use rows::{
    JointRange, NamedRecording, RowBlock, TermScopes, accumulate, for_each_predicted_block,
    for_each_row_block, for_each_tile, predict_tile,
};
pub use statistics::{ONE_SIDED_5, student, two_sided};
pub use system::{Estimate, JointFactor, Solution, System, estimate};
pub use uncertainty::{CalibratedParameter, deviation_digits, noise_bandwidth_factor, with_deviation};
pub use validation::{
    ComparedJoint, Comparison, JointMetrics, Metrics, Prediction, ValidatedRows, Validation, compare,
    extrapolations, predict, validate,
};
pub use variable_projection::{
    FittedShape, ShapeOptions, ShapeReport, calibrate_shapes, calibrate_shapes_rows, shapes_of,
};
