//! The model in question, fitted to the rows that may fit it.

use aurt_calibration::LoadTorqueChoice;
use aurt_traits::{JointStack, LoadTorque, RobotModel};

use crate::error::DiagnosisError;
use crate::evidence::gram::BlockMoments;
use crate::evidence::problem::Problem;
use crate::evidence::total::TotalFit;
use crate::hypotheses::group::Switch;
use crate::recordings::partition::Partition;
use crate::recordings::rows::{Fit, Layout, RecordingRows, Role};
use crate::request::Question;

/// The baseline: what is questioned.
#[derive(Debug, Clone)]
pub struct Baseline {
    /// Load torque of its load-dependent friction.
    pub load: LoadTorque,
    pub coefficients: Vec<f64>,
    /// Whether these are given, and not fitted together with the effects.
    pub frozen: bool,
}

/// Rows of every joint are cut in this many blocks of contiguous time for cross-validation.
pub const BLOCKS: usize = 6;

/// Rows within this time of a cut belong to no block, in periods of `f_dyn_hz`.
pub const GAP_PERIODS: f64 = 2.0;

impl Baseline {
    /// A fit to the rows of all recordings but those for validation.
    ///
    /// # Errors
    /// What evaluation reports.
    pub fn of_all(question: &Question<'_>) -> Result<Self, DiagnosisError> {
        let mut recordings = question.recordings.to_vec();
        for recording in recordings.iter_mut().filter(|r| r.role == Role::Target) {
            recording.role = Role::Calibration;
        }
        Self::new(&Question { recordings: &recordings, ..*question })
    }

    /// The frozen coefficients, or a fit to the calibration recordings' rows (to all rows if there are none).
    ///
    /// # Errors
    /// What evaluation reports.
    pub fn new(question: &Question<'_>) -> Result<Self, DiagnosisError> {
        if let Some(calibration) = question.frozen {
            return Ok(Self {
                load: calibration.load.clone(),
                coefficients: calibration.coefficients(),
                frozen: true,
            });
        }
        let zero = vec![0.0; question.model.parameters().len()];
        let mut load = match question.calibration.load_torque {
            LoadTorqueChoice::Literal => LoadTorque::Literal,
            LoadTorqueChoice::Fitted => LoadTorque::Fitted(zero.clone()),
        };
        let mut coefficients = zero;
        let referenced = question.recordings.iter().any(|r| r.role == Role::Calibration);
        let fitted = if referenced { Role::Calibration } else { Role::Target };
        for _ in 0..2 {
            let fit = Fit { model: question.model, load: &load, coefficients: &coefficients };
            let rows = evaluate_some(question, &fit, |role| role == fitted)?;
            coefficients = fit_rows(question, &rows)?;
            if load == LoadTorque::Literal {
                break;
            }
            load = LoadTorque::Fitted(coefficients.clone());
            if !reads_load(question.model) {
                break;
            }
        }
        // Another simulator is what is questioned; the fit only says what loads the joints.
        let frozen = question.recordings.iter().any(|r| r.simulated.is_some());
        Ok(Self { load, coefficients, frozen })
    }
}

/// Weighted least squares of a model's own columns over the fitted rows of recordings.
fn fit_rows(question: &Question<'_>, rows: &[RecordingRows]) -> Result<Vec<f64>, DiagnosisError> {
    let model = question.model;
    let partition = partition(question, rows);
    let layout = Layout::new(model);
    let problem = Problem::new(&layout, BlockMoments::accumulate(rows, &partition));
    let switches = own_switches(model);
    Ok(weighted_fit(&problem, &switches, &[]).0.coefficients)
}

/// The partition of recordings into blocks.
pub fn partition(question: &Question<'_>, rows: &[RecordingRows]) -> Partition {
    let validated = question.recordings.iter().any(|r| r.role == Role::Validation);
    Partition::new(rows, BLOCKS, GAP_PERIODS / question.f_dyn_hz, validated)
}

/// All coefficients of a model, in all recordings.
pub fn own_switches(model: &RobotModel) -> Vec<Switch> {
    (0..model.parameters().len())
        .map(|column| Switch { column, target_only: false, nonnegative: false })
        .collect()
}

/// OLS for the joints' variances, then least squares weighted by them; the weights are returned, too.
pub fn weighted_fit(problem: &Problem, switches: &[Switch], floor: &[f64]) -> (TotalFit, Vec<f64>) {
    let (_, squared_errors) = problem.least_squares(switches, &vec![1.0; problem.joints()]);
    let weights = problem.weights(&squared_errors, floor);
    (problem.fit(switches, &weights), weights)
}

/// Whether a column of a model depends on what loads the joints; arm terms do not say.
pub(crate) fn reads_load(model: &RobotModel) -> bool {
    let stack =
        |s: &JointStack| s.coulomb().reads_load() || s.hysteresis().reads_load() || s.viscous().reads_load();
    !model.arm_terms().is_empty() || model.stacks().iter().any(stack)
}

/// The rows of all recordings over the columns of a fitted model. With a frozen model or another simulator the
/// measurement is what these leave, and every recording that is not for validation is a target.
///
/// # Errors
/// What evaluation reports.
pub fn evaluate_all(question: &Question<'_>, fit: &Fit<'_>) -> Result<Vec<RecordingRows>, DiagnosisError> {
    evaluate_some(question, fit, |_| true)
}

fn evaluate_some(
    question: &Question<'_>,
    fit: &Fit<'_>,
    asked: impl Fn(Role) -> bool,
) -> Result<Vec<RecordingRows>, DiagnosisError> {
    use rayon::prelude::*;
    let asked: Vec<_> = question.recordings.iter().filter(|r| asked(r.role)).collect();
    asked
        .into_par_iter()
        .map(|r| {
            let mut rows = RecordingRows::of_model(&r.data.name, r.role, &r.data.data, fit)?;
            r.mask(&mut rows);
            Ok(rows)
        })
        .collect()
}

/// The baseline's load torque over the columns of the extended model: those of the own model come first.
pub(crate) fn extended_load(baseline: &Baseline, own: &RobotModel, extended: &RobotModel) -> LoadTorque {
    match &baseline.load {
        LoadTorque::Literal => LoadTorque::Literal,
        LoadTorque::Fitted(weights) => {
            let mut weights = weights[..own.parameters().len()].to_vec();
            weights.resize(extended.parameters().len(), 0.0);
            LoadTorque::Fitted(weights)
        }
    }
}
